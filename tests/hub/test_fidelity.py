"""The fidelity report: numbers by brute force, statements that stand, fall or stay open, files."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Mapping
from functools import cache
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from tools import configure

import owtsweep
import owtsweep.api
from owtsweep.cli import main
from owtsweep.studies.hub import HubStudy, batch
from owtsweep.studies.hub.fidelity import boundaries, consistency, histories, reasons
from owtsweep.studies.hub.fidelity.evidence import AMPLITUDES, PERIODS, SCHEMES, Cell, Evidence
from owtsweep.studies.hub.fidelity.history_statements import HISTORY_STATEMENTS
from owtsweep.studies.hub.fidelity.numbers import compare_numbers, lies_within_records
from owtsweep.studies.hub.fidelity.score import published_numbers
from owtsweep.studies.hub.fidelity.statements import STATEMENTS
from owtsweep.studies.hub.fidelity.summaries import fidelity_table
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.schemes import resolve
from owtsweep.sweep.runs import Run
from owtsweep.verdicts import judgement
from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    UNDECIDED,
    Claim,
    all_of,
    mean_ratio,
)

REPLICATES = 6
EVERYTHING = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: (noise floor F, motion coefficient A) of a scheme's MSE F + N^2 A.
Terms = tuple[float, float]
ALIKE: dict[str, Terms] = {"EKF": (9.0, 9.0), "MKF": (9.0, 9.0), "HME1": (2.0, 0.01)}


def world(
    terms: Mapping[str, Terms] | Callable[[str, float], Mapping[str, Terms]],
    *,
    measures=("position", "velocity"),
    wobble: Mapping[str, float] | None = None,
    periods=PERIODS,
    amplitudes=AMPLITUDES,
    schemes=SCHEMES,
    made: histories.Histories | None = None,
) -> Evidence:
    """A run whose schemes have these terms, by scheme or by (measure, natural period).

    All records differ a little, by a factor that the schemes share. `wobble` moves a scheme's
    records up and down by that part without moving their mean.
    """
    replicate = np.arange(REPLICATES)
    shared = 1.0 + 0.01 * (replicate - replicate.mean())
    up_and_down = np.where(replicate % 2, 1.0, -1.0)
    up_and_down = up_and_down - np.mean(up_and_down * shared) / np.mean(shared)
    rows = []
    for measure, period, scheme in itertools.product(measures, periods, schemes):
        known = terms(measure, period) if callable(terms) else terms
        F, A = known[scheme]
        factor = shared * (1.0 + (wobble or {}).get(scheme, 0.0) * up_and_down)
        for (window, samples), r in itertools.product(
            {"full": 400, "settled": 300}.items(), replicate
        ):
            row = {"natural_period": period, "replicate": r, "scheme": scheme, "measure": measure}
            row |= {"window": window, "amplitude": np.nan, "motion": A * factor[r], "cross": 0.0}
            row |= {"noise": F * factor[r], "value": np.nan, "n_samples": samples}
            rows.append(row | {"status": "ok", "reason": ""})
    return Evidence(
        rows=pd.DataFrame(rows),
        schemes=tuple(schemes),
        periods=tuple(periods),
        amplitudes=tuple(amplitudes),
        window="full",
        histories=made,
    )


def hme2_beyond(boundary: float, **others: Terms) -> dict[str, Terms]:
    """A world in which HME2 is best below that amplitude and HME1 above."""
    return {**ALIKE, **others, "HME2": (1.0, 1.0 / boundary**2 + 0.01)}


PRINTED = published_numbers().set_index(["natural_period", "amplitude", "scheme", "measure"])[
    "published"
]


@cache
def printed(measure: str, period: float) -> dict[str, Terms]:
    """A world that gives all 64 numbers back."""
    parts = {"position": ("x", "y"), "velocity": ("vx", "vy")}.get(measure, (measure,))
    result = {}
    for scheme in SCHEMES:
        F = sum(
            reasons.implied_floor(scheme, part) for part in parts if part in ("x", "y", "vx", "vy")
        )
        N = {3.0: 2.0, 4.0: 0.2, 8.0: 1.0}.get(period)
        if N is None or measure in ("nees", "nis"):
            result[scheme] = (1.0, 1.0)
        else:
            total = sum(PRINTED[period, N, scheme, part] for part in parts)
            result[scheme] = (F, (total - F) / N**2)
    return result


# -- verdicts ------------------------------------------------------------------------------------


def test_ratio_of_means_is_the_paired_t_test_and_its_interval_inverts_it():
    rng = np.random.default_rng(3)
    b = rng.gamma(20.0, 1.0, 12)
    a = 0.8 * b + rng.normal(0.0, 1.5, 12)
    found = mean_ratio("", a, b, 0.9, "below")
    assert found.value == pytest.approx(a.mean() / b.mean())
    assert found.p == pytest.approx(stats.ttest_rel(a, 0.9 * b).pvalue)
    for end in (found.low, found.high):
        assert stats.ttest_rel(a, end * b).pvalue == pytest.approx(0.05)
    assert mean_ratio("", a, b, 0.9, "above").t == -found.t
    exact = mean_ratio("", a, 2.0, 1.0, "above")
    half = stats.t.ppf(0.975, 11) * stats.sem(a) / 2.0
    assert (exact.low, exact.high) == pytest.approx((a.mean() / 2 - half, a.mean() / 2 + half))


def test_a_single_record_and_a_scattered_denominator_decide_nothing():
    one = mean_ratio("", np.array([1.0]), np.array([9.0]), 1.0, "below")
    assert np.isnan(one.low)
    scattered = np.array([1e-3, 2e-3, 40.0])
    wild = mean_ratio("", 1e-3 * scattered + 1e-9, scattered, 1.0, "below")
    assert np.isnan(wild.low)
    assert Claim("", (one,)).verdict == Claim("", (wild,)).verdict == UNDECIDED


def test_many_cells_are_corrected_by_holm():
    holds = mean_ratio("", np.array([1.0, 1.1, 0.9]), np.array([2.0, 2.2, 2.1]), 1.0, "below")
    fails = mean_ratio("", np.array([1.00, 1.30, 1.14]), np.array([0.8, 0.9, 0.9]), 1.0, "below")
    assert 0.02 < fails.p < 0.05
    assert Claim("", (fails,)).verdict == NOT_REPRODUCED
    assert Claim("", (fails, holds)).verdict == NOT_REPRODUCED
    unclear = mean_ratio("", np.array([1.0, 1.4, 0.9]), np.array([1.2, 1.1, 1.0]), 1.0, "below")
    many = Claim("", (fails, unclear, unclear, holds))
    assert many.verdict == UNDECIDED
    assert many.deciding is fails


def test_what_is_missing_can_fall_but_not_stand():
    a, b = np.array([1.0, 1.1, 0.9, 1.0]), np.array([2.0, 2.2, 2.1, 1.9])
    stands = Claim("", (mean_ratio("", a, b, 1.0, "below"),))
    lacks = Claim("", stands.comparisons, ("(3 s, 2 m)",))
    falls = Claim("", (mean_ratio("", b, a, 1.0, "below"),), ("(3 s, 2 m)",))
    assert (stands.verdict, lacks.verdict, falls.verdict) == (REPRODUCED, MISSING, NOT_REPRODUCED)
    assert all_of([stands, lacks]) == MISSING
    assert all_of([stands, lacks, falls]) == NOT_REPRODUCED
    assert all_of([]) == REPRODUCED


# -- statements ----------------------------------------------------------------------------------

EQUAL: dict[str, Terms] = dict.fromkeys(SCHEMES, (2.0, 0.01))
BEST_EKF = {**dict.fromkeys(SCHEMES, (5.0, 1e-3)), "EKF": (0.1, 1e3)}


def mkf_at_two_cells(measure: str, period: float) -> dict[str, Terms]:
    mkf = (1.6, 1.5) if period in (4.0, 5.0) else (5.0, 1.5)
    return {"EKF": (10.0, 1.0), "MKF": mkf, "HME1": (2.0, 1e-3), "HME2": (1.0, 4.0)}


def mkf_far_from_hme1(measure: str, period: float) -> dict[str, Terms]:
    return {**mkf_at_two_cells(measure, period), "EKF": (2.1, 1e-3), "HME1": (9.0, 1.0)}


def growing(measure: str, period: float) -> dict[str, Terms]:
    return hme2_beyond(0.3 * (period / 4.0) ** 2)


def shrinking(measure: str, period: float) -> dict[str, Terms]:
    return hme2_beyond(0.3 * (4.0 / period) ** 2)


def velocity_only(hme1: float, hme2: float) -> Callable[[str, float], dict[str, Terms]]:
    """HME1 and HME2 differ in velocity alone."""

    def terms(measure: str, period: float) -> dict[str, Terms]:
        own = {"HME1": (hme1, 0.01), "HME2": (hme2, 0.01)} if measure == "velocity" else {}
        return {**EQUAL, **own}

    return terms


RESTLESS = {"HME2": 0.6}
CASES = [
    ("F1", REPRODUCED, BEST_EKF, None),
    ("F1", NOT_REPRODUCED, {**BEST_EKF, "EKF": (9.0, 1e3)}, None),
    ("F1", NOT_REPRODUCED, {**BEST_EKF, "EKF": (0.1, 1e-3)}, None),
    ("F1", UNDECIDED, {**BEST_EKF, "EKF": (5.0 - 2.5, 1e3)}, {"EKF": 0.6}),
    ("F2", REPRODUCED, mkf_at_two_cells, None),
    ("F2", NOT_REPRODUCED, {**EQUAL, "MKF": (9.0, 1.0)}, None),
    ("F2", NOT_REPRODUCED, {**EQUAL, "MKF": (1.9, 0.001)}, None),
    ("F2", NOT_REPRODUCED, mkf_far_from_hme1, None),
    ("F2", UNDECIDED, EQUAL, {"MKF": 0.3}),
    ("F3", REPRODUCED, hme2_beyond(0.3), None),
    ("F3", NOT_REPRODUCED, hme2_beyond(1.2), None),
    ("F3", NOT_REPRODUCED, hme2_beyond(0.1), None),
    ("F3", UNDECIDED, hme2_beyond(0.6), RESTLESS),
    ("F4", REPRODUCED, hme2_beyond(1.0), None),
    ("F4", NOT_REPRODUCED, hme2_beyond(0.3), None),
    ("F4", UNDECIDED, hme2_beyond(2.0), RESTLESS),
    ("F5", REPRODUCED, growing, None),
    ("F5", NOT_REPRODUCED, shrinking, None),
    ("F5", NOT_REPRODUCED, lambda m, p: {**growing(m, p), "MKF": (0.5, 9.0)}, None),
    ("F5", UNDECIDED, hme2_beyond(1.0), RESTLESS),
    ("F6", REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (3.0, 0.01)}, None),
    ("F6", NOT_REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (2.0, 0.01)}, None),
    ("F6", NOT_REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (3.8, 0.01)}, None),
    ("F6", UNDECIDED, {**EQUAL, "HME1": (4.0, 0.0), "HME2": (3.4, 0.0)}, {"HME2": 0.1}),
    ("F7", REPRODUCED, hme2_beyond(1.0), None),
    ("F7", NOT_REPRODUCED, hme2_beyond(3.0), None),
    ("F7", UNDECIDED, hme2_beyond(2.0), RESTLESS),
    ("F8", REPRODUCED, velocity_only(2.0, 1.5), None),
    ("F8", NOT_REPRODUCED, velocity_only(1.5, 2.0), None),
    ("F8", UNDECIDED, velocity_only(2.0, 2.0), RESTLESS),
    ("F10", REPRODUCED, EQUAL, None),
    ("F10", NOT_REPRODUCED, {**EQUAL, "MKF": (9.0, -0.01)}, None),
    ("F10", UNDECIDED, {**EQUAL, "MKF": (9.0, 0.0)}, {"MKF": 0.5}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "verdict", "terms", "wobble"), CASES)
def test_statement(name, verdict, terms, wobble):
    claims = STATEMENTS[name](world(terms, wobble=wobble))
    assert all_of(claims) == verdict


def sums(**position) -> dict[tuple[str, str], np.ndarray]:
    """Accumulated errors: HME1 worse by these factors than HME2, by quantity."""
    base = np.array([1.0, 1.02, 0.99, 1.01])
    apart = {"HME1": np.array([1.0, -1.0, -1.0, 1.0]), "HME2": np.array([-1.0, 1.0, 1.0, -1.0])}
    factors = {"position": (0.8, 0.0), "velocity": (1.2, 0.0), "bias": (1.1, 0.0), **position}
    return {
        (scheme, quantity): base * (factor if scheme == "HME1" else 1.0) + spread * apart[scheme]
        for quantity, (factor, spread) in factors.items()
        for scheme in ("HME1", "HME2")
    }


@pytest.mark.parametrize(
    ("name", "verdict", "inside", "accumulated"),
    [
        ("F9", REPRODUCED, [0.97, 0.98, 0.96, 0.97], sums()),
        ("F9", NOT_REPRODUCED, [0.91, 0.92, 0.90, 0.91], sums()),
        ("F9", UNDECIDED, [0.90, 1.00, 0.93, 0.96], sums()),
        ("F11", REPRODUCED, [1.0] * 4, sums()),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(position=(1.2, 0.0))),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(velocity=(0.9, 0.0))),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(bias=(0.9, 0.0))),
        ("F11", UNDECIDED, [1.0] * 4, sums(bias=(1.01, 0.2))),
    ],
)
def test_history_statement(name, verdict, inside, accumulated):
    shares = {"HME1": np.array(inside), "HME2": np.full(len(inside), 0.99)}
    evidence = world(EQUAL, made=histories.Histories(shares, accumulated), periods=[4.0])
    assert all_of(HISTORY_STATEMENTS[name](evidence)) == verdict


def test_cells_and_schemes_that_the_run_lacks_are_named():
    few = world(growing, periods=[4.0])
    verdicts = {name: all_of(test(few)) for name, test in STATEMENTS.items()}
    assert verdicts["F3"] == REPRODUCED  # all it needs is there
    assert verdicts["F1"] == NOT_REPRODUCED  # what is there is enough to fall
    assert {verdicts[name] for name in ("F4", "F5", "F7", "F10")} == {MISSING}
    assert STATEMENTS["F7"](few)[0].missing == ("3 s, 2 m",)
    assert "3 s, 0.05 m" in STATEMENTS["F1"](few)[0].missing

    alone = world(growing, schemes=["HME1"])
    judged = judgement.judge(alone)
    assert [statement.name for statement in judged] == [f"F{i}" for i in range(1, 12)]
    assert {statement.verdict for statement in judged} == {MISSING}
    numbers = compare_numbers(alone)
    assert (numbers["scheme"][numbers["reproduced"].notna()] == "HME1").all()
    table = fidelity_table(alone, numbers, judged, boundaries.all_boundaries(alone))
    assert set(table.loc[table["kind"].isin(["winner", "statement"]), "agrees"]) == {MISSING}
    assert "not in this run" in table["why"][0]


def test_a_definition_is_printed_with_each_statement():
    for statement in judgement.judge(world(EQUAL, periods=[4.0])):
        assert len(statement.definition) > 60
        assert "\n" not in statement.why
        assert statement.text.split()[0] in judgement.published.facts()["statement"].str.cat()


# -- numbers -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def scattered() -> Evidence:
    """Random products, so that every number can be checked by hand."""
    terms = {s: (1e-3 * (i + 1), 1e-3) for i, s in enumerate(SCHEMES)}
    evidence = world(terms, measures=EVERYTHING)
    rng = np.random.default_rng(1)
    rows = evidence.rows.copy()
    for name in ("motion", "noise"):
        rows[name] *= rng.uniform(0.5, 2.0, len(rows))
    rows["cross"] = rng.normal(0.0, 1e-4, len(rows))
    rows.loc[3, "status"] = "failed"
    return Evidence(rows, SCHEMES, PERIODS, AMPLITUDES, "full")


def test_numbers_by_brute_force(scattered):
    table = compare_numbers(scattered)
    assert len(table) == 64
    rows = scattered.rows[scattered.rows["status"] == "ok"]
    for number in table.to_dict("records"):
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
        assert number["record_low"] == pytest.approx(np.percentile(records, 2.5))
        assert number["record_high"] == pytest.approx(np.percentile(records, 97.5))
        assert number["quantile"] == np.mean(records < number["published"])
        assert number["log2"] == pytest.approx(np.log2(mean / number["published"]))
        assert number["missed_by_factor_2"] == (abs(number["log2"]) > 1.0)
        inside = number["record_low"] <= number["published"] <= number["record_high"]
        assert lies_within_records(SimpleNamespace(**number)) == ("yes" if inside else "no")
        assert number["missed_by_factor_2"] == ("% noise" in number["why"].replace(" %", "%"))


def test_the_misprint_of_table_7_is_judged_as_meant(scattered):
    table = compare_numbers(scattered)
    noted = table[table["why"].str.contains("misprint")]
    assert noted[["table", "scheme", "measure", "published"]].to_numpy().tolist() == [
        [7, "EKF", "vx", 1.98e-3]
    ]
    assert "judged at 1.98e-03" in noted["why"].iloc[0]


def test_a_world_that_prints_the_paper_agrees_with_it():
    evidence = world(printed, measures=EVERYTHING)
    numbers = compare_numbers(evidence)
    # tables 7 and 8 give F and A at 8 s, so that nothing is left to fit there
    assert numbers["log2"].abs().max() < 1e-9
    table = fidelity_table(evidence, numbers, [], boundaries.all_boundaries(evidence))
    table = table.set_index("item")
    assert (table["kind"] == "number").sum() == 64
    assert set(table.loc[table["kind"] == "winner", "agrees"]) == {"yes"}
    assert table.loc[table["kind"] == "winner", "ratio"].to_numpy() == pytest.approx(1.0)
    ratios = table[table.index.str.startswith("EKF velocity / position")]
    assert ratios["reproduced"].to_numpy() == pytest.approx(ratios["published"].to_numpy())
    assert set(ratios["agrees"]) == {"yes"}
    assert table.loc["median |log2 ratio|, MKF, HME1, HME2", "agrees"] == "yes"


def test_winners_and_boundaries_that_differ_are_told():
    evidence = world(shrinking, measures=EVERYTHING)
    numbers = compare_numbers(evidence)
    table = fidelity_table(evidence, numbers, [], boundaries.all_boundaries(evidence))
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
    found = boundaries.all_boundaries(evidence)
    table = fidelity_table(evidence, compare_numbers(evidence), [], found).set_index("item")
    assert np.isnan(table.loc["boundary 4 s", "reproduced"])
    assert table.loc["boundary 4 s", "agrees"] == "no"
    assert "HME1 is better at every amplitude" in table.loc["boundary 4 s", "why"]
    why = {statement.name: statement.why for statement in judgement.judge(evidence)}["F3"]
    assert "nan" not in why


def test_schemes_that_coincide_are_no_rivals():
    """With consistent covariances EKF is MKF: it can be best all the same."""
    twins = {**BEST_EKF, "MKF": BEST_EKF["EKF"]}
    claims = STATEMENTS["F1"](world(twins))
    assert all_of(claims) == REPRODUCED
    assert all("HME" in c.label for claim in claims for c in claim.comparisons)
    against_mkf = STATEMENTS["F2"](world({**twins, "MKF": (9.0, 1.0)}))[1]
    assert all(c.label.endswith(("EKF", "HME2")) for c in against_mkf.comparisons)


def test_distances_are_quantiles_of_log_ratios(scattered):
    numbers = compare_numbers(scattered)
    table = fidelity_table(scattered, numbers, [], {}).set_index("item")["reproduced"]
    for group in (["MKF", "HME1", "HME2"], ["EKF"]):
        own = np.abs(numbers.loc[numbers["scheme"].isin(group), "log2"])
        name = ", ".join(group)
        assert table[f"median |log2 ratio|, {name}"] == pytest.approx(np.median(own))
        assert table[f"80th percentile |log2 ratio|, {name}"] == pytest.approx(
            np.percentile(own, 80)
        )


@pytest.mark.parametrize(("part", "name"), [(0, "noise floor"), (1, "motion term")])
def test_the_reason_names_the_term_that_is_off(part, name):
    def off(measure: str, period: float) -> dict[str, Terms]:
        terms = {}
        for scheme, pair in printed(measure, period).items():
            terms[scheme] = tuple(9.0 * v if i == part else v for i, v in enumerate(pair))
        return terms

    cell = Cell(8.0, 1.0)
    evidence = world(off, measures=EVERYTHING)
    value = published_numbers().query("table == 8 and scheme == 'HME1' and measure == 'x'")
    why = reasons.reason(evidence, "HME1", cell, "x", float(value["published"].iloc[0]))
    assert (
        f"mainly the {name}: with the print's own the number would be within a factor of 1.00"
        in why
    )
    assert f"its {name} {'is ' if part == 0 else ''}9 times" in why


def test_start_up_share_by_brute_force(scattered):
    rows = scattered.rows[(scattered.rows["scheme"] == "MKF") & (scattered.rows["measure"] == "vy")]
    rows = rows[rows["natural_period"] == 8.0]
    squares = {}
    for window, part in rows.groupby("window"):
        mse = 0.04 * part["motion"] + 0.4 * part["cross"] + part["noise"]
        squares[window] = (mse * part["n_samples"]).sum()
    share = reasons.start_up_share(scattered, "MKF", Cell(8.0, 0.2), "vy")
    assert share == pytest.approx(1.0 - squares["settled"] / squares["full"])


def test_a_floor_that_single_records_could_fake_is_doubted():
    evidence = world(printed, measures=EVERYTHING)
    rows = evidence.rows.copy()
    rows["noise"] *= 3.0
    sure = Evidence(rows, SCHEMES, PERIODS, AMPLITUDES, "full")
    rows = rows.copy()
    rows["cross"] = np.where(rows["replicate"] % 2, 1.0, -1.0) * 0.1
    unsure = Evidence(rows, SCHEMES, PERIODS, AMPLITUDES, "full")
    arguments = ("EKF", Cell(8.0, 0.2), "x", 3.42e-3)
    assert "not well known" not in reasons.reason(sure, *arguments)
    assert "not well known" in reasons.reason(unsure, *arguments)


# -- consistency ---------------------------------------------------------------------------------


def test_consistency_by_brute_force(scattered):
    table = consistency.consistency(scattered).set_index(["scheme", "natural_period", "amplitude"])
    assert len(table) == 4 * 6 * 10
    values = scattered.values
    chosen = values[(values["scheme"] == "MKF") & (values["amplitude"] == 2.0)]
    chosen = chosen[(chosen["natural_period"] == 5.0) & (chosen["measure"] == "nees")]
    row = table.loc["MKF", 5.0, 2.0]
    nis = values[(values["measure"] == "nis") & (values["natural_period"] == 5.0)]
    nis = nis[(nis["scheme"] == "MKF") & (nis["amplitude"] == 2.0)]
    assert row["nis"] == pytest.approx(nis["value"].mean() / 2.0)
    assert row["nees"] == pytest.approx(chosen["value"].mean() / 4.0)
    half = stats.t.ppf(0.975, len(chosen) - 1) * stats.sem(chosen["value"]) / 4.0
    assert row["nees_high"] - row["nees"] == pytest.approx(half)


@pytest.mark.parametrize(
    ("nees", "nis", "verdict"),
    [
        ((1.1, 1.2), (0.9, 1.1), "optimistic"),
        ((0.9, 1.1), (0.7, 0.9), "pessimistic"),
        ((0.9, 1.1), (0.95, 1.05), "consistent"),
        ((1.1, 1.2), (0.8, 0.9), "mixed"),
        ((0.9, 9.0), (0.95, 1.05), "undecided"),
        ((np.nan, np.nan), (1.1, 1.2), "optimistic"),
        ((np.nan, np.nan), (np.nan, np.nan), "unknown"),
    ],
)
def test_verdict_on_a_cell(nees, nis, verdict):
    assert consistency.verdict([nees, nis]) == verdict


# -- time histories ------------------------------------------------------------------------------


def test_histories_are_those_of_the_sweep():
    """Their squared errors are those that the batch engine sums on the fly."""
    config = configure("record.duration=30", "grid.replicates=2")
    records = make_records(config, histories.NATURAL_PERIOD, [1])
    chain = resolve("HME2").kernel(records.sensors, config, records.steps)
    bias = histories.true_bias_state(config, 1)
    errors = histories.absolute_errors(chain, records, bias)
    direct = batch.direct_sums(chain, batch.Lanes(records), histories.AMPLITUDE, 1)
    squares = direct.products[:, :4, 2, 0].sum(axis=0)
    assert np.sum(errors["position"] ** 2, axis=0) == pytest.approx(squares[:2])
    assert np.sum(errors["velocity"] ** 2, axis=0) == pytest.approx(squares[2:])

    made = histories.make_histories(config)
    assert {len(inside) for inside in made.inside.values()} == {2}
    step = records.sensors.step
    for quantity, error in errors.items():
        assert made.accumulated["HME2", quantity][1] == pytest.approx(error.sum() * step)
    settled = round(config.measures.settling_time / step)
    share = np.mean(errors["velocity"][settled:] <= 0.05)
    assert made.inside["HME2"][1] == pytest.approx(share)


def test_the_bias_state_is_minus_the_rotated_bias_plus_gravity():
    walk = "sensors.imu.bias_walk=0.0"
    config = configure(walk, "sensors.imu.bias_initial=0.3")
    bias = histories.true_bias_state(config, 0)
    R = make_records(config, 4.0, [0]).sensors.rotation
    expected = -R @ np.array([0.3, 0.3]) + np.array(config.sensors.gravity)
    assert bias == pytest.approx(np.tile(expected, (len(bias), 1)))


def test_no_histories_without_both_schemes():
    assert histories.make_histories(configure("schemes=[MKF,HME1]")) is None


# -- the command ---------------------------------------------------------------------------------


class Sources(HTMLParser):
    """Everything that an HTML file would load, and whether its tags close."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.open: list[str] = []
        self.text: list[str] = []

    def handle_starttag(self, tag, attributes):
        self.loaded += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("img", "meta", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def test_the_command_writes_the_report(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    small = [
        "grid.natural_period=[4.0,8.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=3",
        "record.duration=40", "sensors.imu.rate=20", "measures.settling_time=5",
        "hme.smoother_window=5", "hme.mhe.horizon=4", "name=small",
    ]  # fmt: skip
    owtsweep.run(small)
    assert main(["fidelity", "results/small"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out == "12 files: results/small/fidelity/fidelity.html\n"
    folder = tmp_path / "results" / "small" / "fidelity"
    csv = {path.stem: pd.read_csv(path) for path in folder.glob("*.csv")}
    assert set(csv) == {"fidelity", "fidelity_numbers", "fidelity_claims", "consistency"}
    assert ",".join(csv["fidelity"].columns) == (
        "item,kind,published,reproduced,ci_low,ci_high,ratio,agrees,why"
    )
    assert ",".join(csv["fidelity_numbers"].columns) == (
        "table,natural_period,amplitude,scheme,measure,published,reproduced,ci_low,ci_high,"
        "record_low,record_high,quantile,ratio,log2,missed_by_factor_2,why"
    )
    assert ",".join(csv["consistency"].columns) == (
        "scheme,natural_period,amplitude,nees,nees_low,nees_high,nis,nis_low,nis_high,verdict"
    )
    counts = csv["fidelity"]["kind"].value_counts()
    assert counts.to_dict() == {
        "number": 64, "statement": 11, "summary": 8, "boundary": 4, "winner": 4
    }  # fmt: skip
    agrees = csv["fidelity"].set_index("item")["agrees"]
    assert agrees["table 9 winner"] == agrees["table 9 EKF x"] == MISSING
    assert agrees["table 8 EKF x"] in ("yes", "no")

    markdown = (folder / "fidelity.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", markdown)
    assert len(pictures) == 3
    assert all((folder / picture).is_file() for picture in pictures)
    assert "What this run lacks" in markdown
    assert "Table 9 EKF" in markdown.split("What this run lacks")[1]
    for line in ("## Statements", "### F11", "### Table 6", "## Boundary", "mainly the"):
        assert line in markdown

    html = Sources()
    html.feed((folder / "fidelity.html").read_text(encoding="utf-8"))
    assert html.open == []
    assert len(html.loaded) == 3
    assert all(source.startswith("data:image/png;base64,") for source in html.loaded)
    assert "What this run lacks" in html.text


def test_other_folders_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "config.yaml" in error
    other = SimpleNamespace(folder=tmp_path, config=None, study=SimpleNamespace(name="blade"))
    monkeypatch.setattr(owtsweep.api, "load", lambda path: other)
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "study 'blade'" in error
    failed = pd.DataFrame({"status": ["failed"]})
    config = configure()
    broken = Run(tmp_path, config, HubStudy())
    monkeypatch.setattr(Run, "cases", lambda run: failed)
    monkeypatch.setattr(owtsweep.api, "load", lambda path: broken)
    assert main(["fidelity", str(tmp_path)]) == 2
    assert "no case of this run has succeeded" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
