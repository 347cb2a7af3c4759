"""Run folders that older versions wrote: read, verified, and continued without computing."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from owtsweep.api import load
from owtsweep.config import changed
from owtsweep.studies import get_study
from owtsweep.sweep.gather import sort_rows
from owtsweep.sweep.plan import make_plan
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.shard import decode
from owtsweep.sweep.study import Study
from owtsweep.sweep.versions import _read_versions

FIXTURES = Path(__file__).parents[1] / "fixtures"
VERSIONS = ["store-v1", "store-v2", "store-v3", "store-v4"]


@pytest.fixture(params=VERSIONS)
def run(request: pytest.FixtureRequest, tmp_path: Path) -> Run:
    """The fixture in a folder of the test's own, since a damaged shard would be renamed."""
    shutil.copytree(FIXTURES / request.param, tmp_path / request.param)
    return load(tmp_path / request.param)


def shards(run: Run) -> dict[str, bytes]:
    return {
        path.stem.removeprefix("part-"): path.read_bytes()
        for path in run.store.cases.glob("part-*.parquet")
    }


def test_every_shard_is_whole_and_holds_cases(run: Run) -> None:
    stored = shards(run)
    assert len(stored) == 2
    for key, data in stored.items():
        rows = decode(data, key, {}).to_pandas()
        assert len(rows) == 32
        assert set(rows["status"]) == {"ok"}
        pd.testing.assert_frame_equal(run.store.read(key), rows, check_exact=True)
        assert run.store.status(key) == "done"


def test_tables_are_those_of_the_rows(run: Run) -> None:
    rows, missing = run.store.read_all(shards(run))  # by file name: whatever the keys are today
    assert rows is not None
    assert not missing
    made = run.engine.tables(run.config, sort_rows(rows, run.engine.sort_columns()))
    assert set(made) == {"summary", "best_scheme"}
    for name, table in made.items():
        # The t quantile is scipy's, whose last bit is not ours to promise.
        pd.testing.assert_frame_equal(table, run.table(name), rtol=1e-12, check_dtype=False)
    assert list(made["summary"]["mean"]) == list(run.summary()["mean"])


def test_one_fixture_is_of_this_version() -> None:
    study = get_study("hub")
    assert any(versions(load(FIXTURES / name)) == versions_of(study) for name in VERSIONS), (
        "a version was raised: add a run folder that this version writes to tests/fixtures"
    )


def test_keys_are_stable_and_nothing_is_computed_again(run: Run) -> None:
    study, config = run.study, changed(run.config, results=str(run.folder.parent))
    if versions(run) != versions_of(study):
        pytest.skip("its numbers are of another version, so its blocks are computed again")
    before = shards(run)
    assert set(make_plan(study, config)) == set(before), (
        "the keys of stored blocks have changed, so every user's run would be computed again: "
        "leave the content of a block as it was (a new setting at its default must not show in "
        "it), or, if the numbers do change, raise numerics_version of the study"
    )
    cases, summary = run.cases(), run.summary()
    outcome = sweep(study, config)
    assert outcome.run.folder == run.folder
    assert (outcome.computed, outcome.reused, outcome.failed) == (0, 8, [])
    assert shards(run) == before
    pd.testing.assert_frame_equal(run.cases(), cases, check_exact=True)
    pd.testing.assert_frame_equal(run.summary(), summary, rtol=1e-12)


def test_numbers_are_those_of_the_fixture(run: Run, tmp_path: Path) -> None:
    """Computed anew, of any numerics_version: a version stands for last digits, not for more."""
    outcome = sweep(run.study, changed(run.config, results=str(tmp_path / "anew")))
    before, after = (
        frame.sort_values(["scheme", "replicate", "measure", "window"], ignore_index=True)
        for frame in (run.store.read_all(shards(run))[0], outcome.run.cases())
    )
    assert list(before["measure"].astype(str)) == list(after["measure"].astype(str))
    for name in ("motion", "noise"):
        np.testing.assert_allclose(after[name], before[name], rtol=1e-10, err_msg=name)
    scale = np.sqrt(before["motion"] * before["noise"])
    assert np.all(np.abs(after["cross"] - before["cross"]) <= 1e-10 * scale)


def versions(run: Run) -> tuple[int, int]:
    manifest = json.loads((run.folder / "manifest.json").read_text())
    return manifest["schema_version"], manifest["numerics_version"]


def versions_of(study: Study) -> tuple[int, int]:
    return study.schema_version, study.numerics_version


def test_a_pipe_among_the_shards_has_no_version(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "part-0.parquet")
    assert _read_versions(tmp_path / "part-0.parquet", (1, 2)) == (1, 2)
