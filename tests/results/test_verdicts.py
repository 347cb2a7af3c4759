"""The table of a map that gets records until each cell is decided."""

from __future__ import annotations

import math
import re

import numpy as np
import pandas as pd
import pytest

from owtsweep.results.answer import tell_alike, tell_answer, tell_beaten, tell_cell
from owtsweep.results.criteria import MILLIMETRE, Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.ratios import compare_with_best
from owtsweep.results.status import FAILED, OK, UNABLE
from owtsweep.results.summary import summarise
from owtsweep.results.verdicts import Asked, find_open, judge_exactly, make_table
from owtsweep.studies.hub.worlds import CONDITIONS

POSITION = Criterion("position: rms error", "square", "m", *MILLIMETRE)
CONTENDERS = ("NONE", "MKF", "HME1", "HME2")
GRID = {"natural_period": [3.0, 8.0], "amplitude": [0.1, 1.0]}
ASKED = Asked({"position": POSITION}, "settled", CONTENDERS, ["NONE"], 4, 0.05, 256)


def make_rows(records: dict[str, int], period: float = 3.0, seed: int = 1) -> pd.DataFrame:
    """Direct rows of one period: HME1 has 4 cm, MKF 1 % more, HME2 half more, NONE the motion."""
    random = np.random.default_rng(seed)
    shared = random.gamma(60.0, 1.0 / 60.0, size=512)
    own = {name: np.exp(random.normal(0.0, 0.004, 512)) for name in CONTENDERS}
    errors = {"NONE": 0.0, "MKF": 0.0404, "HME1": 0.04, "HME2": 0.06}
    rows = [
        {
            "natural_period": period, "amplitude": amplitude, "scheme": name, "replicate": n,
            "measure": "position", "window": "settled", "status": OK, "reason": "",
            "motion": math.nan, "cross": math.nan, "noise": math.nan, "n_samples": 1000,
            "value": (errors[name] or amplitude / 1.5) ** 2 * shared[n] * own[name][n],
        }
        for amplitude in GRID["amplitude"]
        for name, count in records.items()
        for n in range(count)
    ]  # fmt: skip
    return pd.DataFrame(rows)


def decide(rows: pd.DataFrame) -> pd.DataFrame:
    cube = Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID)
    return make_table(cube, rows, ASKED)


def decide_both(rows: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the tables best_scheme and ratios."""
    cube = Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID)
    table = make_table(cube, rows, ASKED)
    return table, compare_with_best(cube, table, {"position": POSITION})


def ask_more(rows: pd.DataFrame) -> tuple[int, list[list[str]]]:
    cube = Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID)
    records, cells = find_open(cube, rows, ASKED)
    return records, [cell.names for cell in cells]


FIRST = dict.fromkeys(CONTENDERS, 8)
LATER = {**FIRST, "MKF": 32, "HME1": 32}


def test_only_those_that_may_be_best_get_more_records() -> None:
    assert ask_more(make_rows(FIRST)) == (16, [["MKF", "HME1"]] * 2)
    assert ask_more(make_rows({**FIRST, "MKF": 16, "HME1": 16})) == (32, [["MKF", "HME1"]] * 2)
    assert ask_more(make_rows(LATER)) == (0, [])


def test_who_has_left_is_told_as_a_ratio_over_common_records() -> None:
    rows = make_rows(LATER)
    row = decide(rows).query("amplitude == 1.0").iloc[0]
    values = {
        name: rows.query("amplitude == 1.0 and scheme == @name")["value"].to_numpy()
        for name in CONTENDERS
    }
    assert (row["look"], row["n"]) == (3, 32)
    best = values[row["best"]]
    assert row["mse_best"] == pytest.approx(best.mean(), rel=1e-12)
    assert row["error_best"] == pytest.approx(np.sqrt(best.mean()), rel=1e-12)
    assert row["error_low"] < row["error_best"] < row["error_high"]
    assert row["baseline"] == "NONE"
    ratio = values["NONE"].mean() / best[:8].mean()
    assert row["error_baseline"] == pytest.approx(np.sqrt(best.mean() * ratio), rel=1e-12)


def test_less_than_the_margin_is_a_tie_for_the_simplest() -> None:
    close = make_rows(LATER)
    close.loc[close["scheme"] == "MKF", "value"] *= (1.001 / 1.01) ** 2
    row = decide(close).iloc[0]
    assert (row["verdict"], row["best"], row["left"]) == ("tie", "MKF", "MKF; HME1")
    assert not row["distinguishable"]
    sure = decide(make_rows(LATER)).iloc[0]
    assert (sure["verdict"], sure["best"], sure["runner_up"]) == ("won", "HME1", "MKF")


def test_a_baseline_may_be_the_best_and_the_best_scheme_has_a_column() -> None:
    rows = make_rows(FIRST)
    rows.loc[rows["scheme"] == "NONE", "value"] *= 1e-3
    table = decide(rows)
    assert set(table["best"]) == {"NONE"}
    assert set(table["best_scheme"]) == {"HME1"}
    assert set(table["baseline"]) == {"NONE"}


def test_a_contender_that_fails_leaves_and_one_that_is_unable_never_took_part() -> None:
    rows = make_rows(LATER)
    failed = (rows["scheme"] == "HME1") & (rows["replicate"] == 5)
    rows.loc[failed, ["status", "value"]] = [FAILED, np.nan]
    assert set(decide(rows)["best"]) == {"MKF"}
    rows = make_rows(LATER)
    unable = (rows["scheme"] == "HME1") & (rows["amplitude"] == 0.1)
    rows.loc[unable, ["status", "value", "measure", "window"]] = [UNABLE, np.nan, "", ""]
    table = decide(rows)
    assert table["best"].tolist() == ["MKF", "HME1"]
    assert table["status"].tolist() == [UNABLE, OK]
    rows = make_rows(LATER)  # in one record is enough
    once = (rows["scheme"] == "HME1") & (rows["amplitude"] == 0.1) & (rows["replicate"] == 3)
    rows.loc[once, ["status", "value", "measure", "window"]] = [UNABLE, np.nan, "", ""]
    table = decide(rows)
    assert table["best"].tolist() == ["MKF", "HME1"]
    assert table["left"].tolist() == ["MKF", "HME1"]
    assert ask_more(rows) == (0, [])


def test_a_look_with_a_missing_record_is_no_look() -> None:
    rows = make_rows(LATER)
    rows = rows[~((rows["scheme"] == "HME1") & (rows["replicate"] == 20))]
    table = decide(rows)
    assert set(table["look"]) == {2}
    assert set(table["verdict"]) == {"open"}
    assert ask_more(rows) == (32, [["MKF", "HME1"]] * 2)
    assert decide(make_rows(dict.fromkeys(CONTENDERS, 7))).empty


def test_a_superposed_row_stands_for_all_amplitudes() -> None:
    rows = make_rows(FIRST).query("amplitude == 1.0").copy()
    rows = rows.assign(
        amplitude=np.nan, motion=0.0, cross=0.0, noise=rows["value"], value=np.nan
    )  # fmt: skip
    assert decide(rows)["amplitude"].tolist() == [0.1, 1.0]
    assert ask_more(rows)[0] == 16


def test_the_answer_is_told_in_the_unit_with_runner_up_and_no_estimator() -> None:
    table, ratios = decide_both(make_rows(FIRST))
    text = " ".join(tell_answer(table, ratios, POSITION, CONDITIONS))
    assert "HME1 in 2 of 2 cells (0 won, 0 tie, 2 open)" in text
    assert " m, median " in text
    assert "Open after 8 records: natural period 3 s, amplitude 0.1 m: HME1 or MKF; some " in text
    assert "records of both" not in text
    table, ratios = decide_both(make_rows(LATER))
    one = " ".join(tell_cell(table.iloc[[1]], ratios, POSITION))
    assert one.startswith("HME1 is best: error 0.0")
    assert " m (95 %: 0.0" in one
    assert "32 records." in one
    assert re.search(r"Runner-up: MKF, 0.0399 m, 1.0\d+ times as much.", one)
    assert re.search(r"No estimator \(best baseline NONE\): 0.6\d+ m, over 8 records of both.", one)
    text = " ".join(tell_answer(table, ratios, POSITION, CONDITIONS))
    assert re.search(r"times as large, median 1.0\d+\. No estimator", text)
    assert re.search(
        r"No estimator \(best baseline\): [^.]+.*, over 8 records of both\. Fail", text
    )


def test_a_fixed_number_of_records_has_the_same_columns() -> None:
    from owtsweep.results.best_scheme import find_best_schemes

    rows = make_rows(FIRST)
    cube = Cube.of_rows(rows, CONTENDERS[1:], CONDITIONS, GRID)
    fixed = find_best_schemes(cube, "settled", ["position"])
    summary = summarise(cube)
    table = find_best_schemes(cube, "settled", {"position": POSITION})
    assert fixed["error_best"].tolist() == fixed["mse_best"].tolist()
    np.testing.assert_allclose(table["error_best"], np.sqrt(fixed["mse_best"]), rtol=1e-12)
    own = summary.query("scheme == 'HME1' and amplitude == 0.1").iloc[0]
    row = table.query("amplitude == 0.1").iloc[0]
    assert row["error_low"] == pytest.approx(np.sqrt(own["ci_low"]), rel=1e-12)
    assert (row["n"], row["look"], row["verdict"]) == (8, 0, "won")
    ratios = compare_with_best(cube, table, {"position": POSITION})
    assert set(ratios["n"]) == {8}
    (told,) = tell_beaten(["HME2"], table, ratios, POSITION)
    assert "times the least" in told


def test_a_scheme_that_has_left_is_compared_over_the_records_of_both() -> None:
    rows = make_rows(LATER)
    table, ratios = decide_both(rows)
    here = ratios.query("amplitude == 1.0").set_index("scheme")
    values = {
        name: rows.query("amplitude == 1.0 and scheme == @name")["value"].to_numpy()
        for name in CONTENDERS
    }
    assert here["n"].to_dict() == LATER
    ratio = math.sqrt(values["HME2"].mean() / values["HME1"][:8].mean())
    assert here.loc["HME2", "ratio"] == pytest.approx(ratio, rel=1e-12)
    error = ratio * math.sqrt(values["HME1"].mean())
    assert here.loc["HME2", "error"] == pytest.approx(error, rel=1e-12)
    assert here.loc["HME1", "ratio"] == 1.0
    row = table.query("amplitude == 1.0").iloc[0]
    assert here.loc["MKF", "error"] == pytest.approx(row["error_runner_up"], rel=1e-12)
    told, nothing = tell_beaten(["HME2", "HME1", "EKF"], table, ratios, POSITION)
    assert f"{ratio:.3g} times the least, over 8 records of both." in told
    assert nothing == "EKF is best in no cell: it has no result."


def test_who_gives_the_errors_of_another_is_named_and_is_no_runner_up() -> None:
    """HME2 has MKF's errors but for rounding: the runner-up is the simpler of them."""
    rows = make_rows(dict.fromkeys(CONTENDERS, 8))
    is_copy, is_mkf = rows["scheme"] == "HME2", rows["scheme"] == "MKF"
    rows.loc[is_copy, "value"] = rows.loc[is_mkf, "value"].to_numpy() * (1.0 - 1e-12)
    table = decide(rows)
    assert set(table["runner_up"]) == {"MKF"}
    cube = Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID)
    summary = summarise(cube)
    said = "HME2 and MKF give the same errors in every cell"
    assert tell_alike(["HME2"], summary, ["position"]) == [f"{said}."]
    assert tell_alike(["HME1"], summary, ["position"]) == []
    is_copy = summary["scheme"] == "HME2"
    other = summary.assign(measure="velocity")
    other.loc[is_copy, "mean"] *= 1.1
    one_cell = is_copy & (summary["amplitude"] == 1.0)
    apart = summary.assign(mean=summary["mean"].where(~one_cell, 1.1 * summary["mean"]))
    assert tell_alike(["HME2"], apart, ["position"]) == []
    both = pd.concat([summary, other], ignore_index=True)
    assert tell_alike(["HME2"], both, ["position", "velocity"]) == [f"{said}, by position."]


def test_records_after_the_last_look_do_not_move_a_ratio() -> None:
    few, many = make_rows(LATER), make_rows(dict.fromkeys(CONTENDERS, 64))
    table = decide(few)
    cubes = [Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID) for rows in (few, many)]
    one, other = (compare_with_best(cube, table, {"position": POSITION}) for cube in cubes)
    decided = one["scheme"].isin(["HME1", "MKF"])  # the others have left
    pd.testing.assert_frame_equal(one[decided], other[decided])


def test_a_root_is_judged_as_its_square_where_there_are_looks_and_as_it_is_without() -> None:
    from owtsweep.results.best_scheme import find_best_schemes

    root = {"position": Criterion("position", "root", "m", *MILLIMETRE)}
    rows = make_rows(FIRST)
    rows["value"] **= 0.5
    cube = Cube.of_rows(rows, CONTENDERS[1:], CONDITIONS, GRID)
    values = {
        name: rows.query("amplitude == 1.0 and scheme == @name")["value"].to_numpy()
        for name in CONTENDERS
    }
    fixed = find_best_schemes(cube, "settled", root)
    ratios = compare_with_best(cube, fixed, root).query("amplitude == 1.0 and scheme == 'HME2'")
    means = [values[name].mean() for name in ("HME2", "HME1")]
    assert ratios["ratio"].iloc[0] == pytest.approx(means[0] / means[1], rel=1e-12)
    looked = compare_with_best(cube, fixed.assign(look=1), root)
    squares = [(values[name] ** 2).mean() for name in ("HME2", "HME1")]
    told = looked.query("amplitude == 1.0 and scheme == 'HME2'")["ratio"].iloc[0]
    assert told == pytest.approx(math.sqrt(squares[0] / squares[1]), rel=1e-12)


def test_means_side_by_side_are_over_the_records_of_all() -> None:
    rows = make_rows(LATER)
    cube = Cube.of_rows(rows, CONTENDERS, CONDITIONS, GRID)
    shared = summarise(cube, shared=True)
    assert set(shared["n"]) == {8}
    own = summarise(Cube.of_rows(rows[rows["replicate"] < 8], CONTENDERS, CONDITIONS, GRID))
    pd.testing.assert_frame_equal(shared, own)


def test_exact_verdicts_without_any_scheme_are_an_empty_table():
    """That is so where no scheme has an error and only baselines are left."""
    best = pd.DataFrame(columns=["natural_period", "criterion", "best"])
    judged = judge_exactly(best, best.assign(measure="", scheme="", mean=0.0), ASKED)
    assert judged.empty
    assert list(judged.columns) == [*best.columns, "left"]
