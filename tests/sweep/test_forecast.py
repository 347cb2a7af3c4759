"""What --dry-run foretells is what the sweep then does, and nothing is written for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from owtsweep.cli.program import main
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.sweep.prepare import forecast
from owtsweep.sweep.run import sweep


def content(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_it_tells_what_the_sweep_then_computes(study, config, tmp_path):
    told = forecast(study, config())
    assert (told.cases, told.missing, told.seconds, told.memory) == (12, 12, None, None)
    assert list(tmp_path.iterdir()) == []
    run = sweep(replace(study, pause=0.01), config()).run
    shards = sorted(run.store.cases.iterdir())
    shards[0].unlink()
    shards[1].write_bytes(shards[1].read_bytes()[:-1])
    before = content(tmp_path)
    told = forecast(study, config(level=[1.0, 2.0, 0.3, 4.0]))
    assert content(tmp_path) == before
    assert (told.cases, told.missing, told.basis) == (16, 8, "earlier")
    assert 0.01 * 4 <= told.seconds < 1.0  # four blocks, one worker
    assert forecast(study, config(workers=2)).seconds == pytest.approx(told.seconds / 4)
    assert forecast(study, config(), fresh=True).missing == 12
    done = sweep(study, config(level=[1.0, 2.0, 0.3, 4.0]))
    assert done.computed == told.missing


def test_what_the_sweep_refuses_is_refused(study, config, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"^results: "):
        forecast(study, config(results=tmp_path / "file"))
    with pytest.raises(InputError, match=r"^grid: it holds no case"):
        forecast(study, config(level=[]))


def test_the_hub_study_has_a_rate_for_kernels_alone():
    words = ["grid.replicates=20", "record.duration=1000", "tuning=paper", "compute.workers=2"]
    hub = get_study("hub")
    config = compose(words)
    told = forecast(hub, config)
    # A hundredth of a second for each record and scheme, within a factor of four.
    assert 0.25 < told.seconds / (0.5 * 6 * 20 * 4 * 0.0037) < 4.0
    assert 3e8 < told.memory < 1e9
    longer = forecast(hub, changed(config, record=changed(config.record, duration=4000.0)))
    assert longer.seconds == pytest.approx(4 * told.seconds)
    assert forecast(hub, changed(config, engine="reference")).seconds is None


def test_the_command_line_says_it_and_writes_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["grid.replicates=2", "tuning=paper", "compute.workers=2"]
    assert main(["sweep", *words, "--dry-run"]) == 0
    out = capsys.readouterr().out
    assert "cases   840 in all, 0 stored already, 840 to compute\n" in out
    assert "on 2 workers (rough" in out
    assert main(["sweep", *words, "--dry-run", "-m", "seed=1,2"]) == 0
    out = capsys.readouterr().out
    assert "2 runs, one after the other: 1680 cases, 1680 to compute\n" in out
    assert "folder  results/multirun-" in out
    assert main(["sweep", "--dry-run", "-m", "hydra/sweeper=other", "seed=1,2"]) == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["hub", "tower", "floater", "blade", "mating"])
def test_every_study_knows_time_and_memory_before_any_block_has_been_run(name):
    study = get_study(name)
    words = [f"study={name}", "grid.replicates=8", "compute.workers=2"]
    config = compose(words)
    told = forecast(study, config)
    assert told.seconds > 0.1
    assert 3e8 < told.memory < 3e9
    more = forecast(study, changed(config, grid=changed(config.grid, replicates=16)))
    assert more.seconds == pytest.approx(2 * told.seconds)


@pytest.mark.parametrize("name", ["tower", "floater", "blade", "mating"])
def test_every_scheme_has_been_timed(name):
    costs = get_study(name if name != "mating" else "blade").contest().costs
    assert {*costs.schemes} == {*get_study(name).schemes()}


def test_a_users_scheme_has_no_time():
    config = compose(["study=floater"])
    plan = get_study("floater").engine(config).plan(config)[:1]
    plan = [replace(block, content={**block.content, "scheme": "MINE"}) for block in plan]
    assert get_study("floater").engine(config).predict(config, plan, 1) is None


@pytest.mark.parametrize(
    "words",
    [
        ["vary", "sensors.gnss.rate=1,2"],
        ["vary", "study=floater", "grid.snr=10,20"],
        ["tune"],
        ["tune", "study=blade"],
    ],
)
def test_vary_and_tune_tell_time_and_memory_and_write_nothing(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*words, "--dry-run"]) == 0
    out = capsys.readouterr().out
    assert "time    some " in out
    assert "memory  some " in out
    assert list(tmp_path.iterdir()) == []
