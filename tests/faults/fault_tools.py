"""What the fault tests share."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from dummy_study import DummyStudy, make_config

from owtsweep.sweep.run import sweep

ROOT = Path(__file__).parents[2]
CHILD = Path(__file__).with_name("child.py")


def environment() -> dict[str, str]:
    """For subprocesses: ours and the tests' modules are importable."""
    paths = [str(ROOT / part) for part in ("src", "tests/helpers", "tests/faults")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1"}


def content(folder: Path) -> dict[str, bytes]:
    """Shards and tables of a run, byte for byte."""
    paths = [*folder.glob("cases/part-*.parquet"), *folder.glob("*.csv")]
    return {path.name: path.read_bytes() for path in paths}


def undisturbed(folder: Path, levels: int) -> dict[str, bytes]:
    """The content of a run that nothing disturbs."""
    config = make_config(folder, level=[float(i + 1) for i in range(levels)])
    return content(sweep(DummyStudy(), config).run.folder)


def child(*words: object, faults: Mapping[str, str] | None = None) -> subprocess.Popen[str]:
    """Start `child.py` in a session of its own."""
    return subprocess.Popen(
        [sys.executable, str(CHILD), *map(str, words)],
        env={**environment(), "FAULTS": json.dumps(faults or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def only_run(results: Path) -> Path:
    """The one run folder below `results`."""
    (config,) = results.glob("*/config.yaml")
    return config.parent
