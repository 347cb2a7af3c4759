"""`vary` of every study: errors from paired records over the values of one key."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from rich.console import Console

from owtsweep import run
from owtsweep.cli import BAD_INPUT, DONE, main
from owtsweep.results.conditions import Condition
from owtsweep.studies.base.varying.drawing import draw
from owtsweep.studies.base.varying.errors import Errors
from owtsweep.studies.base.varying.sentences import answer_each
from owtsweep.studies.base.varying.varied import VariedErrors
from owtsweep.studies.registry import compose

#: A small configuration of each study, and a key with two values.
QUICK = {
    "floater": ["record.duration=60", "schemes=[KF,KF_BIAS,FIXED_LAG]", "grid.snr=10,30"],
    "blade": [
        "record.duration=50", "record.settling=20", "schemes=[HOLD,MEKF]", "sensors.fix_rate=1,5",
    ],
    "mating": [
        "record.duration=50", "record.settling=20", "schemes=[HOLD,PENDULUM]",
        "grid.hub_sigma=0.01,0.05",
    ],
}  # fmt: skip


def make_errors(**changes: object) -> Errors:
    error = np.array([[0.2, 0.1, 0.3], [0.4, 0.2, 0.25]])[:, :, None]
    best = error == error.min(axis=0)
    made = Errors(
        along=Condition("value", "sensors.rate", "Hz", "log"), values=(1.0, 2.0, 5.0),
        schemes=("A", "B"), cells=("amplitude 1 m",), title="rms error (m)", unit="m", error=error,
        best=best, best_scheme=best, facts=("tuning x",), table=pd.DataFrame(),
    )  # fmt: skip
    return replace(made, **changes)  # type: ignore[arg-type]


def tell(errors: Errors) -> str:
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(VariedErrors(errors).answer())
    return console.export_text()


@pytest.mark.parametrize("study", QUICK)
def test_each_study_varies_a_key(
    study: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [f"study={study}", f"results={tmp_path}", "compute=single", "grid.replicates=2"]
    assert main(["vary", *words, *QUICK[study]]) == DONE
    out = " ".join(capsys.readouterr().out.split())
    assert "2 paired records" in out
    (folder,) = tmp_path.glob("vary-??????????")
    table = pd.read_csv(folder / "vary.csv")
    assert table["value"].nunique() == 2
    chosen = table[(table["criterion"] == compose([f"study={study}"]).criterion)]  # type: ignore[attr-defined]
    assert (chosen["n"] == 2).all()
    assert (chosen["ci_low"] <= chosen["error"]).all()
    assert (folder / "vary.png").is_file()


def test_the_errors_are_those_of_a_sweep_of_the_same_records(tmp_path: Path) -> None:
    words = ["study=floater", "grid.replicates=3", "record.duration=60", "record.rate=10"]
    cell = ["axes=[delay,bias]", "grid.delay=[4]", "grid.bias=[0.03]", "compute=single"]
    words = [*words, *cell, "schemes=[KF,KF_BIAS]", f"results={tmp_path}"]
    assert main(["vary", *words, "grid.snr=10,30"]) == DONE
    swept = run([*words, "grid.snr=[30]"])
    table = pd.read_csv(next(tmp_path.glob("vary-??????????")) / "vary.csv")
    mine = table[(table["value"] == 30) & (table["criterion"] == "velocity")]
    rows = swept.cases()
    squares = rows[rows["measure"] == "velocity"].groupby("scheme", observed=True)["value"]
    want = squares.apply(lambda values: float(np.sqrt((values**2).mean())))
    for _, line in mine.iterrows():
        assert line["error"] == pytest.approx(want[line["scheme"]], rel=1e-12)


def test_a_second_question_takes_the_cases_of_the_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["study=floater", f"results={tmp_path}", "compute=single", "grid.replicates=2"]
    words += ["record.duration=60", "record.rate=10", "schemes=[KF]"]
    assert main(["vary", *words, "grid.snr=10,20"]) == DONE
    capsys.readouterr()
    assert main(["vary", *words, "grid.snr=20,30"]) == DONE
    assert "2 of them stored already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["grid.snr=10"], "or ask `advise` about one"),
        (["grid.snr=10,20", "grid.replicates=auto"], "grid.replicates: `vary` compares the same"),
        (["grid.snr=10,20", "grid.delay=[0,1,2,4]", "grid.bias=[0,0.1]"], "8 cells are too many"),
        (["criterion=velocity,position"], "criterion: its values differ in grid, schemes or"),
        (["grid.nsr=10,20"], "grid.nsr"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["vary", "study=floater", *words, f"results={tmp_path / 'r'}"]) == BAD_INPUT
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert not (tmp_path / "r").exists()


def test_a_terminal_of_80_columns_cuts_no_number() -> None:
    schemes, apart = ("EKF", "MKF", "HME1", "HME2"), ("NONE", "HOLD", "DELTA")
    error = np.random.default_rng(0).uniform(0.03, 0.1, (7, 3, 1))
    best = error == error.min(axis=0)
    errors = make_errors(
        values=(1.0, 2.5, 10.0), schemes=schemes, apart=apart, error=error, best=best,
        best_scheme=best[:4], bound=np.full(3, 0.0351), footnotes=("Thin: baselines.",),
    )  # fmt: skip
    texts = " ".join(" ".join(text.get_text() for text in draw(errors).findobj(Text)).split())
    assert "Thin: baselines." in texts
    told = tell(errors)
    assert "…" not in told
    for number in error.flat:
        assert f" {number:.3g} " in told


def test_a_table_with_intervals_has_the_two_least_errors() -> None:
    errors = make_errors()
    told = tell(replace(errors, interval=(0.9 * errors.error, 1.2 * errors.error)))
    rows = [line.split() for line in told.splitlines()]
    assert ["2", "A", "0.1", "0.09", "to", "0.12", "B", "0.2"] in rows


def test_the_sentences_say_what_the_numbers_are() -> None:
    errors = make_errors(further=(("Twice.",),))
    assert list(answer_each(errors)) == [
        "From 1 Hz to 5 Hz the best scheme's error rises from 0.2 m (A) to 0.25 m (B). The error "
        "is smallest at 2 Hz: 0.1 m (A). Twice."
    ]
    names = make_errors(along=Condition("value", "tuning"), values=("x", "y", "z"))
    assert list(answer_each(names)) == [
        "The best scheme's error is smallest with y (A, 0.1 m) and largest with z (B, 0.25 m)."
    ]
    holes = errors.error.copy()
    holes[:, 1] = np.nan
    assert next(answer_each(make_errors(error=holes))).startswith("No scheme has an error at 2 Hz")


def test_many_equally_good_schemes_are_counted() -> None:
    error = np.array([0.4, 0.3, 0.1, 0.2])[:, None, None].repeat(3, axis=1)
    every = np.ones_like(error, dtype=bool)
    errors = make_errors(schemes=("A", "B", "C", "D"), error=error, best=every, best_scheme=every)
    assert errors.name_best(0, 0) == "C or 3 others"
