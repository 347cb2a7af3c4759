"""Which scheme, by how much, and whether it matters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from replay_tools import config_of, motion_file

from owtsweep.studies.replay import advice, blocks, describe
from owtsweep.studies.replay.results import rank_schemes

NAMES = ["EKF", "MKF", "HME1"]
RANKS = {"MKF": 17, "HME1": 19}


def pairs(best: float, second: float, spread: float, n: int = 20) -> np.ndarray:
    draw = np.random.default_rng(0)
    common = 0.2 * draw.standard_normal(n)  # of the record: it cancels in pairs
    noise = spread * draw.standard_normal(n)
    return np.array([second + common + noise, second + common + noise, best + common])


def test_a_clear_winner():
    found = advice.compare(pairs(1.0, 1.2, 0.05), NAMES)
    assert (found["best"], found["runner_up"], found["matters"]) == ("HME1", "MKF", True)
    assert found["ci_low"] < 0.2 < found["ci_high"]
    assert found["margin"] == pytest.approx(found["difference"] / found["value_best"])
    assert found["n"] == 20


def test_too_small_a_margin_does_not_matter():
    found = advice.compare(pairs(1.0, 1.03, 0.001), NAMES)
    assert found["best"] == "HME1"
    assert found["ci_low"] > 0.0
    assert not found["matters"]


def test_an_interval_that_holds_zero_does_not_matter():
    found = advice.compare(pairs(1.0, 1.1, 1.0), NAMES)
    assert found["ci_low"] < 0.0
    assert not found["matters"]


def test_schemes_that_are_the_same_are_one():
    values = pairs(1.2, 1.0, 0.0)
    found = advice.compare(values, NAMES)
    assert (found["best"], found["same_as"], found["runner_up"]) == ("MKF", "EKF", "HME1")


def test_only_what_all_finished_is_compared():
    values = pairs(1.0, 1.2, 0.05)
    values[2, :3] = np.nan
    assert advice.compare(values, NAMES)["n"] == 17
    values[0] = np.nan
    assert advice.compare(values, NAMES)["runner_up"] == "MKF"
    assert advice.compare(np.full((3, 2), np.nan), NAMES) is None
    alone = advice.compare(values[2:], ["HME1"])
    assert (alone["runner_up"], alone["matters"]) == ("", False)


def rows(measure: str, replicates: int) -> pd.DataFrame:
    lines = []
    for scheme, value in (("MKF", 2.0), ("HME1", 1.0)):
        for replicate in range(replicates):
            lines.append((scheme, replicate, measure, "settled", value + 0.01 * replicate))
        for part in range(20):
            wobble = 0.1 * np.sin(part)
            lines.append((scheme, 0, measure, f"part_{part:02d}", value + value * wobble))
    return pd.DataFrame(lines, columns=["scheme", "replicate", "measure", "window", "value"])


def test_draws_are_compared_in_pairs_and_a_single_record_piece_by_piece():
    found = advice.advise(rows("position", 5), RANKS, "position", "settled")
    assert (found["source"], found["n"], found["best"]) == ("record", 5, "HME1")
    found = advice.advise(rows("position", 1), RANKS, "position", "settled")
    assert (found["n"], found["window"]) == (20, "settled")
    assert found["ci_low"] < found["difference"] < found["ci_high"]
    assert found["value_best"] == 1.0  # the whole settled record's; the pieces make the interval


def test_without_errors_the_fixes_advise():
    found = advice.advise(rows("fix_residual", 1), RANKS, "position", "settled")
    assert (found["source"], found["criterion"]) == ("fixes", "fix_residual")
    assert "distances from later fixes" in describe.tell_row({**found, "noise": "stated"})


def test_the_noise_counts_that_is_better_on_fixes_that_were_withheld():
    stated, estimated = {"value_recommended": 0.01}, {"value_recommended": 0.009}
    advice.prefer_better(stated, estimated)
    assert (stated["counts"], estimated["counts"]) == (False, True)
    advice.prefer_better(stated, stated | {"value_recommended": 0.01})
    assert stated["counts"]


def answer(*rows: dict) -> list[str]:
    config = config_of([Path("a.csv")])
    noise = pd.DataFrame([{"parameter": "sensors.gnss.sigma", "estimate": 0.02}])
    return describe.tell_answer(config, {"advice": pd.DataFrame(rows), "noise": noise})


def test_the_answer_is_in_the_words_of_a_sweep():
    row = {
        "source": "record", "criterion": "position", "best": "HME1", "same_as": "", "n": 20,
        "value_best": 0.04, "runner_up": "MKF", "value_runner_up": 0.09, "noise": "stated",
        "counts": True, "recommended": "HME1", "value_recommended": 0.04, "left": "HME1",
        "recommended_ci_low": 0.01, "recommended_ci_high": 0.09, "baseline": "HOLD",
        "value_baseline": 0.25,
    }  # fmt: skip
    assert answer(row) == [
        "HME1 is best: error 0.200 m (95 %: 0.1 to 0.3), 20 draws.",
        "Runner-up: MKF, 0.300 m, 1.5 times as much.",
        "No estimator (best baseline HOLD): 0.500 m.",
    ]
    tie = row | {"recommended": "MKF", "value_recommended": 0.0441, "left": "MKF; HME1"}
    said = answer(tie)
    assert said[0].startswith("MKF is the simplest of a tie: error 0.210 m")
    assert said[1] == "Runner-up: HME1, 0.200 m, 0.9524 times as much."
    assert said[-1] == "Not surely worse: HME1."
    parts = {"source": "fixes", "criterion": "fix_residual", "recommended_ci_low": np.nan}
    said = answer(row | parts)
    assert said[0] == "HME1 is best: error 0.200 m, 20 parts."
    assert "distances from later fixes" in said[-2]
    # .2 m are a mean square of .04 m^2, of which 2 x .02^2 are the fixes'
    assert said[-1] == "Without that noise, 0.0200 m per axis, it is some 0.198 m."
    alike = row | {"same_as": "EKF", "recommended": "EKF", "left": "EKF; HME1"}
    assert answer(alike)[0].startswith("EKF is best")
    by_map = row | {"source": "map", "counts": False}
    assert answer(by_map) == []
    second = row | {"noise": "estimated"}
    assert answer(row | {"counts": False}, second)[-1].startswith("Run with the noise that")
    assert answer(row, second | {"counts": False})[-1].startswith("Run with the stated noise")


def test_several_records_are_judged_together():
    mean = {"EKF": 2.0, "SKFA": 1.0, "no_estimate": 9.0}
    errors = pd.DataFrame(
        [
            (f"{number}.csv", scheme, "position", "settled", value + 0.1 * number)
            for scheme, value in mean.items()
            for number in range(6)
        ],
        columns=["file", "scheme", "measure", "window", "mean"],
    )
    config = config_of([Path("0.csv"), Path("1.csv")])
    said = describe.tell_answer(config, {"errors": errors, "advice": pd.DataFrame()})
    assert said[0].startswith("SKFA is best: error 1.12 m (95 %: ")
    assert said[0].endswith("6 records.")
    assert said[2] == "No estimator (best baseline NONE): 3.04 m."


def test_skfa_is_a_contender_of_every_replay_and_the_least_simple():
    ranks = rank_schemes(config_of([Path("a.csv")]))
    assert list(ranks) == ["EKF", "MKF", "HME1", "HME2", "SKFA"]
    assert max(ranks, key=ranks.__getitem__) == "SKFA"


def test_all_schemes_are_judged_at_the_same_steps(tmp_path):
    file = motion_file(tmp_path / "a.csv", duration=45.0)
    config = config_of([file], "schemes=[MKF,SKFA]", "replay.replicates=1")
    rows = pd.concat([table for _, table in blocks.run(config, blocks.plan(config))])
    judged = rows[(rows["measure"] == "position") & (rows["window"] == "settled")]
    assert {"MKF", "SKFA", "no_estimate"} <= {*judged["scheme"]}
    assert judged["n_samples"].nunique() == 1
