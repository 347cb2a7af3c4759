"""Shards of another version are computed again, and the run says so."""

from __future__ import annotations

from dataclasses import replace

from owtsweep.sweep.run import sweep
from owtsweep.sweep.versions import all_versions, tell_other_versions


def test_raised_version_recomputes_and_says_so(study, config, caplog):
    old = sweep(study, config(level=[1.0, 2.0]))
    before = {path.name: path.read_bytes() for path in old.run.store.cases.iterdir()}
    caplog.clear()
    new = sweep(replace(study, numerics_version=2), config(level=[1.0, 2.0, 3.0]))
    assert (new.computed, new.reused) == (12, 0)
    line = "8 cases are recomputed: numerics version 1 -> 2"
    assert line in caplog.messages
    assert line in (new.run.folder / "run.log").read_text()
    # The old ones stay, for whoever still runs the old version.
    assert all((new.run.store.cases / name).read_bytes() == data for name, data in before.items())
    caplog.clear()
    sweep(replace(study, schema_version=3), config(level=[1.0]))
    assert sorted(m for m in caplog.messages if "recomputed" in m) == [
        "4 cases are recomputed: schema version 1 -> 3",
        "4 cases are recomputed: schema version 1 -> 3, numerics version 2 -> 1",
    ]


def test_other_settings_and_sweeps_that_go_on_are_no_versions(study, config, caplog):
    sweep(study, config(level=[1.0]))
    sweep(study, config(level=[1.0, 2.0]))
    outcome = sweep(study, config(level=[3.0]))
    (outcome.run.store.cases / "part-junk.parquet").write_bytes(b"junk")
    sweep(study, config(level=[4.0]))
    assert "recomputed" not in caplog.text


def test_worker_of_another_version_says_what_differs(study):
    expected = all_versions(study)
    assert tell_other_versions(study, expected) == ""
    told = tell_other_versions(replace(study, numerics_version=2), expected)
    assert told.startswith("the worker has numerics_version 2 instead of 1; ")
    assert "owtsweep_version 0" not in told
