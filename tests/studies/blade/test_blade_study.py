"""The blade study as a sweep: contract, command line, refusals."""

from __future__ import annotations

import re
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import owtsweep
from owtsweep.cli import main
from owtsweep.studies import compose, get_study
from owtsweep.studies.base.schemes import Scheme, SchemeTable, Unable
from owtsweep.studies.blade.schemes import SCHEMES
from owtsweep.sweep.plan import make_plan, make_tasks
from owtsweep.testing import check_study

#: Short records, quick schemes, two cells.
TINY = [
    "study=blade", "record.duration=60", "record.settling=20", "sensors.outage_every=40",
    "grid.sigma=[0.006]", "grid.outage=[0,20]", "grid.replicates=2", "schemes=[HOLD,MEKF]",
    "compute=single",
]  # fmt: skip


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_study_keeps_the_contract() -> None:
    check_study(get_study("blade"), compose([*TINY, "compute.backend=threading"]))


def test_a_sweep_says_who_is_best_and_who_waits() -> None:
    words = ["tuning=[paper,matched]", "schemes=[HOLD,MEKF,PENDULUM,SMOOTHER]", "name=two"]
    result = owtsweep.run([*TINY, *words])
    tables = result.tables()
    assert set(tables["summary"]["scheme"]) == {"HOLD", "MEKF", "PENDULUM", "SMOOTHER"}
    best = tables["best_scheme"]
    assert set(best["best"]) | set(best["runner_up"]) <= {"HOLD", "MEKF", "PENDULUM"}
    assert set(best["criterion"]) == {"root", "attitude", "worst"}
    shown = StringIO()
    config = result.config.by_tuning()["matched"]
    of_tuning = {name: table[table["tuning"] == "matched"] for name, table in tables.items()}
    Console(file=shown, width=300).print(result.engine.terminal(config, of_tuning))
    assert "Not in the contest, because its estimates wait: SMOOTHER." in shown.getvalue()
    assert main(["figures", "results/two"]) == 0
    assert {path.stem for path in Path("results/two/figures").glob("*.png")} == {
        f"map_{name}_{tuning}"
        for name in ("root", "attitude", "worst")
        for tuning in ("paper", "matched")
    }


def test_the_rows_of_a_run_judge_nothing_of_the_paper(
    capsys: pytest.CaptureFixture[str],
) -> None:
    owtsweep.run([*TINY, "name=one", "grid.replicates=1", "schemes=[HOLD]"])
    assert main(["fidelity", "results/one"]) == 2
    told = capsys.readouterr().err
    assert "study 'blade'" in told
    assert "python -m experiments.maes2018.fidelity judges them" in told
    assert told.count("\n") == 1


def test_runs_can_be_compared() -> None:
    multirun = ["sweep", "--multirun", *TINY, "unit=fog,mems"]
    assert main(multirun) == 0
    (folder,) = Path("results").glob("multirun-*")
    assert main(["compare", str(folder)]) == 0


def test_one_bad_record_does_not_take_others_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = SCHEMES.resolve("HOLD")

    class Moody(Scheme):
        name = "HOLD"
        count = 0

        def prepare(self, setting):
            self.count += 1
            if self.count == 3:
                raise Unable("it is Friday")
            self.setting = setting
            return self if self.count == 1 else sound.prepare(setting)

        def run(self, measured):
            estimates = sound.prepare(self.setting).run(measured)
            estimates.root[-1] = np.nan
            return estimates

    config = compose([*TINY, "schemes=[HOLD]"])
    moody = Moody()
    monkeypatch.setattr(SchemeTable, "resolve", lambda table, name: moody)
    study = get_study("blade")
    tasks = make_tasks(make_plan(study, config))
    run_blocks = study.engine(config).run
    rows = [rows for task in tasks for _, rows in run_blocks(config, [*task.values()])]
    told = [tuple(row) for part in rows for row in part[["status", "reason"]].to_numpy()]
    assert list(dict.fromkeys(told)) == [
        ("failed", "the estimate is not finite"), ("ok", ""), ("unable", "it is Friday")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["axes=[sigma,speed]"], r"axes: there is no axis 'speed'; use two of sigma, outage"),
        (["axes=[sigma,sigma]"], r"axes: sigma stands there twice"),
        (["axes=[period,sigma]", "grid.outage=[0]"], r"grid\.period: the map is over period, and"),
        (["grid.lever=[0,1]"], r"grid\.lever: it has 2 values, and the map is over sigma and out"),
        (["record.duration=1"], r"record\.duration: 1 s at 50 Hz are 50 samples; give 100 to"),
        (["record.settling=59"], r"record\.settling: 59 s leave 50 samples .* at least 100"),
        (["schemes=[KF]"], r"schemes: there is no scheme 'KF' here \(but in study=floater\); u"),
        (["+motion.freedoms.x={period:3}"], r"motion.freedoms.* no degree of freedom is called x"),
        (["motion.freedoms.pitch.sigma=40"], r"motion\.freedoms\.pitch\.sigma: 40 deg reaches 120"),
        (["grid.heading=[60]"], r"grid\.heading: 60 deg reaches 180 deg; give less"),
        (["motion.freedoms.u.damping=1"], r"motion\.freedoms\.u\.damping: 1 must be below 1"),
        (["motion.bending.damping=2"], r"motion\.bending\.damping: 2 must be below 1"),
        (["motion.bending.sag=7"], r"motion\.bending\.sag: 7 is more than 1.5; lower it"),
        (["motion.bending.vibration=.01", "motion.bending.period=.1"],
         r"motion\.bending\.period: record\.rate=50 Hz is too slow for 0\.1 s; give 0\.6 s or"),
        (["motion.tugger.damping=3"], r"motion\.tugger\.damping: 3 gives heading a damping"),
        (["motion.tugger.heading=1e5"], r"record\.rate: 50 Hz is too slow for a motion of 0\.0632"),
        (["boom.rate=50"], r"boom\.rate: 50 Hz is no whole multiple of 20 Hz up to 1000 Hz; 2"),
        (["boom.modes.aside.period=.1"], r"boom\.modes\.aside\.period: 0\.1 s vibrates up to 30 H"),
        (["boom.modes.second.damping=1"], r"boom\.modes\.second\.damping: 1 must be below 1"),
        (["boom.follow=[1,1]"], r"boom\.follow"),
        (["record.rate=5"], r"record\.rate: 5 Hz is too slow for a motion of 5 s \(w\); give 6 Hz"),
        (["sensors.fix_rate=100"], r"sensors\.fix_rate: GNSS at 100 Hz is faster than the inert"),
        (["sensors.fix_rate=7"], r"sensors\.fix_rate: 7 Hz is no part of record.*; give 7\.14286$"),
        (["grid.outage=[0,40]"], r"grid\.outage: 40 s leave no fix; give less than sensors\.outa"),
        (["grid.offset=[30]"], r"grid\.offset: 30 s are half of a record of 60 s; give less"),
        (["grid.lever=[1000]"], r"grid\.lever: 1000 m is longer than a blade allows; give at m"),
        (["filters.lag=60"], r"filters\.lag: the lag is not shorter than the record of 60 s"),
        (["sensors.prism_rate=0.1"], r"sensors\.prism_rate: 0\.1 Hz are fewer than 10 positions"),
        (["grid.sigma=[0]"], r"grid\.sigma"),
        (["unit.force_sigma=0"], r"unit\.force_sigma"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line_that_says_what_works(words, says, capsys) -> None:
    assert main(["sweep", *TINY, *words]) == 2
    told = capsys.readouterr().err.strip()
    assert "\n" not in told
    assert re.search(says, told), told
    assert not Path("results").exists()
