"""A sweep with grid.replicates=auto goes on until its cells are decided, and goes on anew."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import owtsweep
from owtsweep.cli.program import main
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.sweep.prepare import forecast

HUB = [
    "tuning=matched", "measures.window=settled", "record.duration=60", "grid.natural_period=[4,8]",
    "grid.amplitude=[0.05,0.3,3]", "schemes=[MKF,HME1,HME2]", "grid.replicates=auto",
    "grid.most=32", "compute=single",
]  # fmt: skip
FLOATER = [
    "study=floater", "record.duration=60", "record.rate=10", "record.settling=20",
    "grid.delay=[0,2]", "grid.bias=[0.1]", "schemes=[LOWPASS,KF,KF_BIAS]", "grid.replicates=auto",
    "grid.most=16", "compute=single",
]  # fmt: skip


def sweep(words: list[str], folder: Path) -> Any:
    return owtsweep.run([*words, f"results={folder}"])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return sweep(HUB, tmp_path_factory.mktemp("whole"))


def test_cells_have_as_many_records_as_they_need(whole: Any) -> None:
    table = whole.best_scheme().query("criterion == 'position'")
    assert len(table) == 6
    assert {8, 16, 32} >= {*table["n"]} > {8}
    assert {*table["verdict"]} <= {"won", "tie", "open"}
    assert (table["verdict"] == "won").any()
    counts = whole.cases().query("status == 'ok'").groupby("scheme")["replicate"].nunique()
    assert counts["NONE"] >= 8
    assert counts.max() == table["n"].max()
    loaded = owtsweep.load(whole.folder)
    pd.testing.assert_frame_equal(loaded.best_scheme(), whole.best_scheme())
    remade = loaded.make_results(loaded.stored()[0])[""].tables["best_scheme"]
    pd.testing.assert_frame_equal(
        remade, whole.best_scheme().drop(columns="tuning"), check_dtype=False, rtol=1e-15
    )


def test_a_sweep_that_was_stopped_between_looks_goes_on_to_the_same_table(
    whole: Any, tmp_path: Path
) -> None:
    first = sweep([*HUB, "grid.budget=1e-9"], tmp_path)
    assert {*first.best_scheme()["look"]} == {1}
    again = sweep(HUB, tmp_path)
    assert again.folder == first.folder
    pd.testing.assert_frame_equal(again.best_scheme(), whole.best_scheme())
    blocks = [
        json.loads((run.folder / "plan.json").read_text())["blocks"] for run in (again, whole)
    ]
    assert blocks[0] == blocks[1]


def test_stored_records_and_workers_change_nothing(whole: Any, tmp_path: Path) -> None:
    sweep([*HUB, "grid.replicates=32"], tmp_path)
    words = [word for word in HUB if word != "compute=single"]
    again = sweep([*words, "compute.workers=2"], tmp_path)
    pd.testing.assert_frame_equal(again.best_scheme(), whole.best_scheme())


def test_more_records_continue_and_change_no_verdict(whole: Any, tmp_path: Path) -> None:
    few = sweep([*HUB, "grid.most=8"], tmp_path).best_scheme()
    cells = ["natural_period", "amplitude", "criterion"]
    both = few.merge(whole.best_scheme(), on=cells, suffixes=("", "_later"))
    decided = both[both["verdict"] != "open"]
    assert len(decided)
    for column in ("verdict", "best", "look", "n", "mse_best", "mse_runner_up"):
        assert decided[column].tolist() == decided[f"{column}_later"].tolist()


def test_each_other_study_decides_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", *FLOATER, f"results={tmp_path}"]) == 0
    out, err = capsys.readouterr()
    assert err.startswith("48 cases, ")
    assert "Error of the best: " in out
    assert max(map(len, out.splitlines()[:-1])) <= 80
    (folder,) = tmp_path.iterdir()
    table = pd.read_csv(folder / "best_scheme.csv")
    assert {*table["criterion"]} == {"velocity", "position", "worst"}
    assert {*table["n"]} <= {8, 16}
    assert len(json.loads((folder / "plan.json").read_text())["blocks"]) >= 6


def test_a_forecast_tells_the_first_look_and_the_most(capsys: pytest.CaptureFixture[str]) -> None:
    config = compose(HUB)
    told = forecast(get_study("hub"), config)
    assert told.cases == 8 * 6 * 6  # contenders: three schemes and three baselines
    assert told.most == 4 * told.cases
    assert main(["sweep", *HUB, "--dry-run"]) == 0
    assert f"{told.cases} for the first look (at most {told.most})" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("grid.margin=0", "grid.margin: 0 must be a finite number above zero"),
        ("grid.margin=1.5", "grid.margin: 1.5 is more than 1"),
        ("grid.most=4", "grid.most: 4 is not the number of records of a look; use one of 8, 16"),
        ("grid.most=100", "grid.most: 100 is not the number of records of a look"),
        ("grid.replicates=some", "grid.replicates: 'some' is neither a whole number nor auto"),
        ("grid.replicates=inf", "grid.replicates: inf is neither a whole number nor auto"),
        ("grid.replicates=nan", "grid.replicates: nan is neither a whole number nor auto"),
        ("grid.replicates=0", "grid.replicates: 0 must be at least 1"),
        ("grid.budget=0", "grid.budget: 0 s must be a finite number above zero"),
    ],
)
def test_wrong_input_is_refused_in_one_line(word: str, line: str) -> None:
    for words in (HUB, FLOATER):
        with pytest.raises(InputError) as error:
            compose([*words, word])
        assert str(error.value).startswith(line)
        assert "\n" not in str(error.value)
