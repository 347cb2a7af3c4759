"""The tower study as a sweep: contract, command line, refusals."""

from __future__ import annotations

import re
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from rich.console import Console

import owtsweep
from owtsweep import load
from owtsweep.cli import main
from owtsweep.figures import distributions
from owtsweep.results.conditions import spread as spread_axis
from owtsweep.studies import compose, get_study
from owtsweep.studies.tower.contest import describe_noise
from owtsweep.studies.tower.setting import misjudge
from owtsweep.sweep.plan import make_plan
from owtsweep.testing import check_study

STRUCTURE = Path(__file__).with_name("small.yaml")
#: A small structure, a short record, quick schemes, two cells.
TINY = [
    "study=tower", f"structure={STRUCTURE}", "record.duration=20", "record.rate=20",
    "record.settling=10", "truth.subdivision=1", "grid.noise=[1]", "grid.soil_factor=[0.5,1]",
    "grid.replicates=1", "sensors.inclinometers=[0,20,80,110]", "sensors.accelerometers=[50,110]",
    "schemes=[MDE,QUASI_STATIC]", "compute.backend=threading", "compute.workers=1",
]  # fmt: skip


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_study_keeps_the_contract() -> None:
    check_study(get_study("tower"), compose(TINY))


def test_a_sweep_says_who_is_best_and_what_the_sensors_miss(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    blind = [word for word in TINY if "inclinometers" not in word]
    words = ["tuning=[paper,matched]", "sensors.inclinometers=[0,110]", "schemes=[AKF,MDE]"]
    assert main(["sweep", *blind, *words, "name=two", "seed=1"]) == 0
    assert "unable: 4 cases: AKF is blind" in capsys.readouterr().err
    run = load("results/two")
    both = run.tables()
    best = both["best_scheme"]
    assert set(best["tuning"]) == {"paper", "matched"}
    assert set(best["best"]) == {"MDE"}
    assert set(best["status"]) == {"unable"}
    shown = StringIO()
    config = run.config.by_tuning()["paper"]
    tables = {name: table[table["tuning"] == "paper"] for name, table in both.items()}
    Console(file=shown, width=300).print(run.engine.terminal(config, tables))
    assert "Best scheme by damage: |log2 of estimated over true|" in shown.getvalue()
    assert "Position and velocity of the rigid translation are unseen" in shown.getvalue()
    assert re.search(
        r"At 1 % of noise the quietest inclinometer has [\d.e-]+ microrad, the quietest "
        r"accelerometer has [\d.e-]+ micro-g, fore-aft \(standard deviation per sample at 20 Hz",
        shown.getvalue(),
    )
    assert "A real inclinometer reads theta - a/g, which no scheme here knows" in shown.getvalue()
    assert "4 unknown inputs" in (run.folder / "run.log").read_text()
    monkeypatch.setattr(distributions, "LEAST_RECORDS", 1)
    assert len(run.draw("distributions_paper")) == 2


def test_the_rows_of_a_run_judge_nothing_of_the_paper(
    capsys: pytest.CaptureFixture[str],
) -> None:
    owtsweep.run([*TINY, "name=one", "schemes=[QUASI_STATIC]"])
    assert main(["fidelity", "results/one"]) == 2
    told = capsys.readouterr().err
    assert "study 'tower'" in told
    assert "python -m experiments.simpson2025.fidelity judges them" in told
    assert told.count("\n") == 1


def test_what_noise_is_in_microrad_and_g_is_told_of_the_sensors_that_are_there() -> None:
    table = pd.DataFrame({
        "measure": ["noise_theta", "noise_theta", "noise_a"], "noise": [1.0, 10.0, 10.0],
        "mean": [2e-6, 20e-6, 10.0 * 5e-6 * 9.80665],
    })  # fmt: skip
    config = compose([*TINY, "faults.accelerated_inclinometers=true"])
    noise, fault = describe_noise(config, table)
    assert "inclinometer has 2 microrad, the quietest accelerometer has 5 micro-g" in noise
    assert fault == "The inclinometers here read theta - a/g, and no scheme knows it."
    bare = compose([*TINY, "sensors.inclinometers=[]", "schemes=[MDE]"])
    assert describe_noise(bare, table[:0]) == []


def test_a_scheme_without_soil_counts_at_every_soil_factor() -> None:
    config = compose([*TINY, "grid.soil_factor=[0.5,1,2]"])
    plan = list(make_plan(get_study("tower"), config).values())
    assert [block.content.get("soil_factor") for block in plan] == [0.5, None, 1.0, 2.0]
    assert sum(block.cases for block in plan) == 6
    rows = pd.DataFrame({"soil_factor": [0.5, np.nan], "value": [7.0, 8.0]})
    spread = spread_axis(rows, {"soil_factor": config.grid.soil_factor})
    assert spread.to_numpy().tolist() == [[0.5, 7.0], [0.5, 8.0], [1.0, 8.0], [2.0, 8.0]]


def test_the_models_errors_are_those_of_the_section() -> None:
    errors = {"stiffness": 1.1, "mass": 0.9, "damping": 2.0, "rotor_mass": 1.2, "water_level": 3.0}
    config = compose([*TINY, *(f"model.{name}={value}" for name, value in errors.items())])
    true, wrong = config.structure, misjudge(config)
    assert wrong.tubes[1].youngs_modulus == pytest.approx(1.1 * true.tubes[1].youngs_modulus)
    assert wrong.tubes[2].density == pytest.approx(0.9 * true.tubes[2].density)
    assert wrong.points[0].mass == pytest.approx(1.2 * true.points[0].mass)
    assert wrong.points[0].inertia == pytest.approx(1.2 * true.points[0].inertia)
    assert (wrong.damping, wrong.water.level) == (2.0 * true.damping, 3.0)
    assert misjudge(compose(TINY)) == true


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["grid.noise=[0,1]"], r"grid\.noise: 0 % makes the covariance R .* singular"),
        (["sensors.inclinometers=[3]"], r"sensors\.inclinometers: no node .* 3 m above the ground"),
        (["sensors.gnss=[110,110]"], r"sensors: two sensors of a kind .* once"),
        (["cuts=[0,60]"], r"cuts: the high one at 60 m above the ground is inside an element"),
        (["cuts=[0,20]"], r"cuts: 1 element between 0 and 20 m above the ground; .* 2 or more"),
        (["cuts=[50,0]"], r"cuts: the lower cut at 50 m is not below the upper one at 0 m"),
        (["fatigue.curve=own", "fatigue.branches=[{m:3}]"], r"fatigue\.branches\[0\]\.log_a: .*"),
        (["record.settling=19"], r"record\.settling: 19 s leave 20 samples .* at least 100"),
        (["schemes=[AKF,FOO]"], r"schemes: there is no scheme 'FOO'; use AKF"),
        (["structure=nowhere.yaml"], r"nowhere\.yaml: there is no such file"),
        (["wind.file=nowhere.csv"], r"nowhere\.csv: there is no such file"),
        (["sensors.inclinometers=[]", "sensors.accelerometers=[]"],
         r"sensors: sparse_theta_a has none, so no load at a cut \(F0, M0, F175, M175\)"),
        (["sensors.inclinometers=[]", "schemes=[AKF]"],
         r"sensors: no scheme can work with the set-up sparse_theta_a: it does not tell F0, M0, "
         r"F175, M175 apart; add inclinometers at .* m$"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", *TINY, *words]) == 2
    told = capsys.readouterr().err
    assert re.fullmatch(rf"owtsweep: {says}.*\n", told), told
    assert not Path("results").exists()


def test_noise_of_rates_is_that_of_the_sea() -> None:
    tuning = compose([*TINY, "tuning=paper", "filters.process_noise=1e-5"]).filters
    assert tuning.find_rate_noise(waves=False) == tuning.find_rate_noise(waves=True) == 1e-5
    told = compose([*TINY, "filters.rate_noise=1e-3", "filters.rate_noise_in_waves=1e-1"]).filters
    assert (told.find_rate_noise(waves=False), told.find_rate_noise(waves=True)) == (1e-3, 1e-1)
    calm = compose([*TINY, "tuning=paper", "filters.rate_noise=1e-3"]).filters
    assert calm.find_rate_noise(waves=True) == 1e-3
