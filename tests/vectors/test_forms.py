"""Whole sweeps with LLVM vectors and as plain loops: the same bits."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest


@pytest.mark.faults
@pytest.mark.parametrize("changes", [[], ["evaluation=direct"], ["engine=expected"]])
def test_both_forms_give_the_same_rows(changes: list[str], tmp_path: Path) -> None:
    rows = {}
    for vectors in ("true", "false"):
        done = subprocess.run(
            [
                sys.executable, "-m", "owtsweep", "sweep", "grid=small", "grid.replicates=3",
                "tuning=paper", "record.duration=60",
                f"results={tmp_path}", f"name=vectors-{vectors}",
                f"compute.vectors={vectors}", *changes,
            ],
            capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        shards = sorted((tmp_path / f"vectors-{vectors}" / "cases").glob("*.parquet"))
        rows[vectors] = {path.name: pd.read_parquet(path) for path in shards}
    assert len(rows["true"]) > 0
    assert rows["true"].keys() == rows["false"].keys()
    for name, table in rows["true"].items():
        pd.testing.assert_frame_equal(table, rows["false"][name], check_exact=True)
