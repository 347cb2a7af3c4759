"""The 64 published numbers and the summary of everything, by brute force."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from fidelity_worlds import (
    BEST_EKF,
    EQUAL,
    EVERYTHING,
    printed,
    scattered_world,
    shrinking,
    world,
)
from scipy import stats

from experiments.ren2019 import plots
from experiments.ren2019.consistency import judge_consistency
from experiments.ren2019.evidence import SCHEMES, Evidence
from experiments.ren2019.fidelity import judge_all, judge_along_x
from experiments.ren2019.numbers import compare_numbers, lies_within_records
from experiments.ren2019.sections import number_table
from experiments.ren2019.summaries import fidelity_table, statement_row
from owtsweep.figures import style
from owtsweep.verdicts.inference import REPRODUCED


@pytest.fixture(scope="module")
def scattered() -> Evidence:
    return scattered_world()


@pytest.fixture(scope="module")
def numbers(scattered) -> pd.DataFrame:
    """The 64 numbers beside those of the scattered world."""
    return compare_numbers(scattered)


@pytest.fixture(scope="module")
def summary(scattered, numbers) -> pd.DataFrame:
    """The table fidelity.csv of the scattered world, by item."""
    return summarise(scattered, numbers).set_index("item")


def summarise(evidence: Evidence, numbers: pd.DataFrame) -> pd.DataFrame:
    """Make the table fidelity.csv of a run."""
    scores = [evidence.scores]
    return fidelity_table(evidence, numbers, judge_all(scores), judge_along_x(scores))


def test_numbers_by_brute_force(scattered, numbers):
    assert len(numbers) == 64
    rows = scattered.rows[scattered.rows["status"] == "ok"]
    for number in numbers.to_dict("records"):
        part = rows[(rows["scheme"] == number["scheme"]) & (rows["measure"] == number["measure"])]
        part = part[
            (part["natural_period"] == number["natural_period"]) & (part["window"] == "full")
        ]
        N = number["amplitude"]
        records = (N**2 * part["motion"] + 2 * N * part["cross"] + part["noise"]).to_numpy()
        mean = records.mean()
        assert number["reproduced"] == pytest.approx(mean)
        low, high = stats.t.interval(0.95, len(records) - 1, mean, stats.sem(records))
        assert (number["ci_low"], number["ci_high"]) == pytest.approx((max(low, 0.0), high))
        logs, n = np.log(records), len(records)
        spread = np.std(logs, ddof=1) * np.sqrt(1.0 + 1.0 / n)
        ends = np.exp(stats.t.interval(0.95, n - 1, logs.mean(), spread))
        assert (number["record_low"], number["record_high"]) == pytest.approx(tuple(ends))
        distance = np.log(number["published"]) - logs.mean()
        chance = 2.0 * stats.t.sf(abs(distance) / spread, n - 1)
        assert number["chance"] == pytest.approx(chance)
        assert number["log2"] == pytest.approx(np.log2(mean / number["published"]))
        assert number["missed_by_factor_2"] == (abs(number["log2"]) > 1.0)
        inside = number["record_low"] <= number["published"] <= number["record_high"]
        assert lies_within_records(SimpleNamespace(**number)) == ("yes" if inside else "no")
        assert number["missed_by_factor_2"] == ("% noise" in number["why"].replace(" %", "%"))


def test_the_misprint_of_table_7_is_judged_as_meant(numbers):
    noted = numbers[numbers["why"].str.contains("misprint")]
    assert noted[["table", "scheme", "measure", "published", "printed"]].to_numpy().tolist() == [
        [7, "EKF", "vx", 1.98e-3, 1.98e-2]
    ]
    assert "judged at 1.98e-03" in noted["why"].iloc[0]


def test_the_misprint_is_marked_wherever_it_is_listed_as_published(numbers, summary):
    listed = number_table(numbers).rows
    assert [row for row in listed if "printed" in row[2]] == [
        next(row for row in listed if row[:3] == ["EKF", "vx", "1.98e-03 (misprinted as 1.98e-02)"])
    ]
    marked = summary.index[summary["why"].str.contains("misprint")]
    assert set(marked) == {"table 7 EKF vx", "EKF velocity / position MSE, table 7"}


def test_a_world_that_prints_the_paper_agrees_with_it():
    evidence = world(printed, measures=EVERYTHING)
    numbers = compare_numbers(evidence)
    # tables 7 and 8 give F and A at 8 s, so that nothing is left to fit there
    assert numbers["log2"].abs().max() < 1e-9
    table = summarise(evidence, numbers)
    table = table.set_index("item")
    assert (table["kind"] == "number").sum() == 64
    assert set(table.loc[table["kind"] == "winner", "agrees"]) == {"yes"}
    assert table.loc[table["kind"] == "winner", "ratio"].to_numpy() == pytest.approx(1.0)
    ratios = table[table.index.str.startswith("EKF velocity / position")]
    assert ratios["reproduced"].to_numpy() == pytest.approx(ratios["published"].to_numpy())
    assert set(table.loc[table["kind"] == "number", "agrees"]) == {"yes"}


def test_winners_and_boundaries_that_differ_are_told():
    evidence = world(shrinking, measures=EVERYTHING)
    numbers = compare_numbers(evidence)
    table = summarise(evidence, numbers)
    agrees = table.set_index("item")["agrees"]
    value = table.set_index("item")["reproduced"]
    assert value["boundary 4 s"] == pytest.approx(0.3, rel=1e-3)
    assert value["boundary 6 s"] == pytest.approx(0.3 / 2.25, rel=1e-3)
    assert value["boundary 8 s / 4 s"] == pytest.approx(0.25, rel=1e-3)
    items = ["boundary 4 s", "boundary 6 s", "boundary 8 s / 4 s"]
    assert agrees[items].tolist() == ["yes", "no", "no"]
    winners = ["table 6 winner", "table 7 winner", "table 8 winner", "table 9 winner"]
    assert agrees[winners].tolist() == ["yes", "no", "no", "yes"]
    assert value["table 8 winner"] == pytest.approx((1.0 + 1.0 / 0.075**2) / 2.0, rel=0.02)


def test_without_a_boundary_the_cells_decide():
    evidence = world({**EQUAL, "HME1": (1.0, 0.01)}, measures=EVERYTHING)
    table = summarise(evidence, compare_numbers(evidence)).set_index("item")
    assert np.isnan(table.loc["boundary 4 s", "reproduced"])
    assert table.loc["boundary 4 s", "agrees"] == "no"
    assert "HME1 is better at every amplitude" in table.loc["boundary 4 s", "why"]
    judged = {statement.name: statement for statement in judge_all([evidence.scores])}
    assert "nan" not in statement_row(judged["F3"]).why


def test_schemes_that_coincide_are_no_rivals():
    """With consistent covariances EKF is MKF: it can be best all the same."""
    twins = {**BEST_EKF, "MKF": BEST_EKF["EKF"]}
    first = judge_all([world(twins).scores])[0]
    assert first.verdict == REPRODUCED
    assert all("HME" in c.label for claim in first.claims for c in claim.decisions)
    against_mkf = judge_all([world({**twins, "MKF": (9.0, 1.0)}).scores])[1].claims[1]
    assert all(c.label.endswith(("EKF", "HME2")) for c in against_mkf.decisions)


def test_distances_are_quantiles_of_log_ratios(numbers, summary):
    table = summary["reproduced"]
    for group in (["MKF", "HME1", "HME2"], ["EKF"]):
        own = np.abs(numbers.loc[numbers["scheme"].isin(group), "log2"])
        name = ", ".join(group)
        assert table[f"median |log2 ratio|, {name}"] == pytest.approx(np.median(own))
        assert table[f"80th percentile |log2 ratio|, {name}"] == pytest.approx(
            np.percentile(own, 80)
        )


@pytest.mark.parametrize(
    ("schemes", "value"),
    [
        (SCHEMES, 0.0), (("EKF",), 1e-299),
        *(
            pytest.param(("EKF",), value, marks=pytest.mark.faults)
            for value in (0.0, -1.0, 1e139)
        ),
    ],
)  # fmt: skip
def test_values_of_a_perfect_scheme_and_of_a_forged_run_are_told_without_a_warning(schemes, value):
    """Warnings are errors in tests."""
    evidence = world(
        {**EQUAL, **dict.fromkeys(schemes, (value, value))}, measures=EVERYTHING, periods=(4.0, 8.0)
    )
    numbers = compare_numbers(evidence)
    table = summarise(evidence, numbers).set_index("item")
    judge_consistency(evidence)
    shown = table.loc["table 8 EKF x", "reproduced"]
    assert shown == pytest.approx(2.0 * value)
    with style.context():
        for figure in (
            plots.scatter(numbers),
            plots.ratios(numbers),
        ):
            figure.canvas.draw()
