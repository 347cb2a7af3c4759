"""The floater study as a sweep: contract, command line, refusals."""

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
from owtsweep.studies import compose, get_study
from owtsweep.studies.base.schemes import Scheme, SchemeTable, Unable
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth
from owtsweep.sweep.plan import make_plan, make_tasks
from owtsweep.testing import check_study

#: A short record, quick schemes, two cells.
TINY = [
    "study=floater", "record.duration=60", "record.rate=10", "record.settling=20",
    "grid.delay=[0,2]", "grid.bias=[0.1]", "grid.replicates=2", "schemes=[KF,KF_REPAIRED]",
    "compute=single",
]  # fmt: skip


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def run(words: list[str]) -> pd.DataFrame:
    """Return the rows of all blocks, each run in this process."""
    config, study = compose([*TINY, *words]), get_study("floater")
    run_blocks = study.engine(config).run
    tasks = make_tasks(make_plan(study, config))
    return pd.concat([rows for task in tasks for _, rows in run_blocks(config, [*task.values()])])


def test_the_study_keeps_the_contract() -> None:
    check_study(get_study("floater"), compose([*TINY, "compute.backend=threading"]))


def test_a_sweep_says_who_is_best_and_who_waits() -> None:
    words = ["tuning=[paper,matched]", "schemes=[KF,KF_REPAIRED,FIXED_LAG]", "name=two"]
    result = owtsweep.run([*TINY, *words])
    tables = result.tables()
    assert set(tables["summary"]["scheme"]) == {"KF", "KF_REPAIRED", "FIXED_LAG"}
    best = tables["best_scheme"]
    assert set(best["best"]) | set(best["runner_up"]) == {"KF", "KF_REPAIRED"}
    knows = best[(best["tuning"] == "matched") & (best["delay"] == 2) & (best["bias"] == 0.1)]
    assert set(knows["best"]) == {"KF_REPAIRED"}
    assert list(knows["criterion"]) == ["velocity", "position", "worst"]
    alone = run(["tuning=matched", "schemes=[KF_REPAIRED]"])
    alone = alone[(alone["measure"] == "velocity") & (alone["delay"] == 2)]["value"].mean()
    assert knows["mse_best"].iloc[0] == pytest.approx(alone)
    shown = StringIO()
    config = result.config.by_tuning()["matched"]
    of_tuning = {name: table[table["tuning"] == "matched"] for name, table in tables.items()}
    Console(file=shown, width=300).print(result.engine.terminal(config, of_tuning))
    assert "Best scheme by velocity: rms error over standard deviation" in shown.getvalue()
    assert "Not in the contest, because its estimates wait: FIXED_LAG." in shown.getvalue()


def test_the_rows_of_a_run_judge_nothing_of_the_paper(
    capsys: pytest.CaptureFixture[str],
) -> None:
    owtsweep.run([*TINY, "name=one", "grid.replicates=1", "schemes=[KF]"])
    assert main(["fidelity", "results/one"]) == 2
    told = capsys.readouterr().err
    assert "study 'floater'" in told
    assert "python -m experiments.mehammer2018.fidelity judges them" in told
    assert told.count("\n") == 1


def test_planes_are_runs_of_their_own_that_can_be_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(distributions, "LEAST_RECORDS", 2)
    words = ["grid.snr=[10,20]", "grid.loss=[0,0.1]", "grid.delay=[0]", "plane=snr_loss"]
    rest = [word for word in TINY if "grid.delay" not in word and "grid.bias" not in word]
    multirun = ["sweep", "--multirun", *rest, *words, "sensors.lost_as=zeros,missing"]
    assert main([*multirun, "grid.bias=[0.1]"]) == 0
    (folder,) = Path("results").glob("multirun-*")
    assert main(["compare", str(folder)]) == 0
    one = next(folder.glob("floater-*"))
    assert main(["show", str(one)]) == 0
    assert {"snr", "loss"} < set(load(str(one)).tables()["best_scheme"])
    assert main(["figures", str(one)]) == 0
    assert {path.stem for path in (one / "figures").glob("*.png")} == {
        "map_velocity", "map_position", "map_worst", "distributions",
    }  # fmt: skip


def test_more_records_and_schemes_keep_the_blocks_that_are_there() -> None:
    study = get_study("floater")
    few = make_plan(study, compose([*TINY, "grid.replicates=10"]))
    many = make_plan(study, compose([*TINY, "grid.replicates=25", "schemes=[KF_BIAS,KF]"]))
    kept = [block for key, block in many.items() if key in few]
    assert [block.label for block in kept] == [
        f"KF, delay {delay} samples, bias 0.1, replicates 0-9" for delay in (0, 2)
    ]
    assert sorted({block.cases for block in many.values()}) == [5, 10]
    assert sum(block.cases for block in many.values()) == 2 * 2 * 25
    long = make_plan(study, compose([*TINY, "grid.replicates=4", "record.duration=30000"]))
    assert {block.cases for block in long.values()} == {1}


def test_one_bad_record_does_not_take_others_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = SCHEMES.resolve("KF")

    class Moody(Scheme):
        name = "KF"

        def __init__(self) -> None:
            self.count = 0

        def prepare(self, setting):
            self.count += 1
            if self.count == 3:
                raise Unable("it is Friday")
            return self if self.count == 1 else sound.prepare(setting)

        def run(self, measured):
            estimates = sound.prepare(make_setting(config, motion, cell)).run(measured)
            estimates.position[-1] = np.nan
            return estimates

    config = compose(TINY)
    (cell, _) = CONTEST.list_cells(config)
    motion = make_truth(config, 0)
    moody = Moody()
    monkeypatch.setattr(SchemeTable, "resolve", lambda table, name: moody)
    rows = run(["schemes=[KF]"])
    told = rows.drop_duplicates(["delay", "replicate"])[["status", "reason"]].to_numpy().tolist()
    assert told == [
        ["failed", "the estimate is not finite"], ["ok", ""], ["unable", "it is Friday"], ["ok", ""]
    ]  # fmt: skip


def test_what_is_believed_does_not_change_the_noise_that_errors_are_compared_with() -> None:
    words = ["plane=believed_snr", "grid.delay=[0]", "grid.snr=[20]", "grid.believed=[1,100]"]
    rows = run([*words, "schemes=[KF]"])
    ratio = rows[rows["measure"] == "noise_ratio_x"].set_index(["believed", "replicate"])["value"]
    square = rows[rows["measure"] == "mse_position_x"].set_index(["believed", "replicate"])["value"]
    sigma = np.sqrt(square) / ratio
    assert sigma[1.0].to_numpy() == pytest.approx(sigma[100.0].to_numpy())
    assert (ratio[1.0] != ratio[100.0]).all()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["axes=[delay,speed]"], r"axes: there is no axis 'speed'; use two of delay, bias, snr"),
        (["axes=[bias,bias]"], r"axes: bias stands there twice"),
        (["axes=[roll,snr]", "grid.delay=[0]"], r"grid\.roll: the map is over roll, and null is"),
        (["grid.snr=[0,10]"], r"grid\.snr: it has 2 values, and the map is over delay and bias; .*"
         r"among axes=\[delay,bias\]"),
        (["record.duration=5"], r"record\.duration: 5 s at 10 Hz are 50 samples; give 100 to"),
        (["record.settling=55"], r"record\.settling: 55 s leave 50 samples .* at least 100"),
        (["schemes=[KF,FOO]"], r"schemes: there is no scheme 'FOO'; use KF_STEADY"),
        (["grid.snr=[inf]"], r"grid\.snr"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", *TINY, *words]) == 2
    told = capsys.readouterr().err
    assert re.fullmatch(rf"owtsweep: {says}.*\n", told), told
    assert not Path("results").exists()
