"""Means, intervals and the best scheme, against naive computations."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from hub_rows import (
    AMPLITUDES,
    PERIODS,
    SCHEMES,
    best_of,
    coinciding,
    find_best,
    make_summary,
    superposed_rows,
    tabulate,
    values_of,
)
from naive_holm import naive_holm
from scipy import stats

from owtsweep.errors import InputError
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise
from owtsweep.studies.hub.measures import MEASURES
from owtsweep.studies.hub.worlds import CONDITIONS

# the columns of summary.csv and best_scheme.csv, which others' scripts rely on
DESIGN_SUMMARY = ["scheme", "natural_period", "amplitude", "measure", "window"]
DESIGN_SUMMARY += ["mean", "ci_low", "ci_high", "n"]
DESIGN_BEST = ["natural_period", "amplitude", "criterion", "window", "best", "runner_up"]
DESIGN_BEST += ["mse_best", "mse_runner_up", "difference", "ci_low", "ci_high", "distinguishable"]
DESIGN_BEST += ["verdict", "best_scheme", "look", "n", "error_best", "error_low", "error_high"]
DESIGN_BEST += ["error_runner_up"]
VALUE_COLUMNS = ["scheme", "natural_period", "amplitude", "measure", "window", "replicate", "value"]


def test_a_table_superposes_every_amplitude():
    rows = superposed_rows(replicates=2)
    values = tabulate(rows)
    assert list(values.columns) == VALUE_COLUMNS
    assert len(values) == len(rows) * len(AMPLITUDES)
    keys = ["scheme", "natural_period", "measure", "window", "replicate"]
    by_key = values.set_index([*keys, "amplitude"])["value"]
    for row in rows.to_dict("records"):
        for n in AMPLITUDES:
            expected = n**2 * row["motion"] + 2 * n * row["cross"] + row["noise"]
            assert by_key[(*(row[key] for key in keys), n)] == pytest.approx(expected, rel=1e-14)


def test_a_table_takes_direct_rows_as_they_are():
    superposed = superposed_rows(schemes=("MKF",), replicates=1)
    direct = superposed_rows(schemes=("EKF",), replicates=1)
    direct["amplitude"], direct["value"] = 1.0, 0.25
    direct[["motion", "cross", "noise"]] = math.nan
    elsewhere = direct.assign(amplitude=4.0)  # an amplitude that the grid does not hold
    values = tabulate(pd.concat([superposed, direct, elsewhere]))
    own = values[values["scheme"] == "EKF"]
    assert set(own["amplitude"]) == {1.0}
    assert set(own["value"]) == {0.25}
    assert set(values["amplitude"]) == set(AMPLITUDES)
    assert len(tabulate(direct)) == len(direct)


def test_a_table_leaves_out_failed_cases_and_undefined_values():
    rows = superposed_rows(schemes=("MKF",), replicates=2)
    rows.loc[rows["measure"] == "nees", ["motion", "cross", "noise"]] = math.nan
    failed = rows.iloc[[0]].assign(
        scheme="HME2", measure="", window="", status="failed", reason="no fix"
    )
    values = tabulate(pd.concat([rows, failed]))
    assert set(values["scheme"]) == {"MKF"}
    assert set(values["measure"]) == {"x", "position", "velocity"}


def test_summary_is_the_students_interval():
    values = tabulate(superposed_rows())
    table = make_summary(values, SCHEMES)
    assert list(table.columns) == DESIGN_SUMMARY
    groups = values.groupby(["scheme", "natural_period", "amplitude", "measure", "window"])
    assert len(table) == groups.ngroups
    for row in table.to_dict("records"):
        sample = groups.get_group(
            tuple(row[k] for k in ("scheme", "natural_period", "amplitude", "measure", "window"))
        )["value"]
        low, high = stats.t.interval(
            0.95, len(sample) - 1, loc=sample.mean(), scale=stats.sem(sample)
        )
        assert row["n"] == len(sample) == 6
        assert row["mean"] == pytest.approx(sample.mean(), rel=1e-12)
        assert (row["ci_low"], row["ci_high"]) == pytest.approx((low, high), rel=1e-9)


def test_summary_is_sorted_by_the_given_schemes_then_numerically():
    values = tabulate(superposed_rows())
    schemes = ["HME2", "EKF", "MKF"]
    table = make_summary(values, schemes)
    assert list(dict.fromkeys(table["scheme"])) == schemes
    first = table[table["scheme"] == "HME2"]
    assert list(dict.fromkeys(first["amplitude"])) == [0.05, 1.0, 10.0]
    assert first["natural_period"].is_monotonic_increasing
    assert list(dict.fromkeys(first["measure"])) == ["x", "position", "velocity", "nees"]


def test_summary_of_unequal_counts_and_of_a_single_replicate():
    values = values_of({"EKF": [1.0, 2.0, 6.0], "MKF": [4.0, math.nan, math.nan]})
    ekf, mkf = make_summary(values, ["EKF", "MKF"]).to_dict("records")
    assert (ekf["mean"], ekf["n"]) == (3.0, 3)
    assert (mkf["mean"], mkf["n"]) == (4.0, 1)
    assert math.isnan(mkf["ci_low"])
    assert math.isnan(mkf["ci_high"])


def test_tables_of_a_run_without_any_value_are_empty():
    rows = superposed_rows(replicates=1).assign(status="failed")
    values = tabulate(rows)
    assert list(make_summary(values, SCHEMES).columns) == DESIGN_SUMMARY
    assert list(find_best(values, SCHEMES, "full").columns) == DESIGN_BEST
    assert make_summary(values, SCHEMES).empty
    assert find_best(values, SCHEMES, "full").empty
    assert coinciding(values, SCHEMES) == []


def test_best_scheme_is_the_paired_comparison_of_every_cell():
    values = tabulate(superposed_rows(replicates=9))
    table = find_best(values, SCHEMES, "settled")
    assert list(table.columns) == DESIGN_BEST
    assert len(table) == len(PERIODS) * len(AMPLITUDES) * 2
    assert set(table["window"]) == {"settled"}
    for criterion in ("position", "velocity"):
        p_values, flags = [], []
        for row in table[table["criterion"] == criterion].to_dict("records"):
            cell = values[
                (values["natural_period"] == row["natural_period"])
                & (values["amplitude"] == row["amplitude"])
                & (values["measure"] == criterion)
                & (values["window"] == "settled")
            ].pivot_table(index="replicate", columns="scheme", values="value")
            best, runner_up = cell.mean().sort_values().index[:2]
            assert (row["best"], row["runner_up"]) == (best, runner_up)
            test = stats.ttest_rel(cell[runner_up], cell[best])
            low, high = test.confidence_interval(0.95)
            assert row["difference"] == row["mse_runner_up"] - row["mse_best"]
            assert row["mse_best"] == pytest.approx(cell[best].mean(), rel=1e-12)
            assert (row["ci_low"], row["ci_high"]) == pytest.approx((low, high), rel=1e-8)
            p_values.append(float(test.pvalue))
            flags.append(row["distinguishable"])
        assert flags == naive_holm(p_values, 0.05)


def test_holm_makes_a_cell_of_many_harder_to_tell_apart():
    pair = {"EKF": [1.0, 1.3, 1.1, 1.2, 1.05], "MKF": [1.4, 1.5, 1.45, 1.9, 1.2]}
    p = stats.ttest_rel(pair["MKF"], pair["EKF"]).pvalue
    assert 0.05 / 4 < p < 0.05
    assert bool(best_of(pair)["distinguishable"])
    alike = {"EKF": [1.0, 1.2, 0.9, 1.1, 1.0], "MKF": [1.2, 1.0, 1.1, 0.9, 1.01]}
    cells = [values_of(pair), *(values_of(alike, amplitude=n) for n in (2.0, 3.0, 4.0))]
    table = find_best(pd.concat(cells), ["EKF", "MKF"], "full", criteria=["position"])
    assert not table["distinguishable"].any()
    assert table["ci_low"].iloc[0] > 0  # the plain interval of that cell still excludes zero


def test_only_replicates_that_all_schemes_finished_are_compared():
    row = best_of({"EKF": [1.0, 2.0, 0.0], "MKF": [2.0, 3.5, math.nan]})
    assert (row["mse_best"], row["mse_runner_up"]) == (1.5, 2.75)


def test_a_scheme_without_any_finished_replicate_takes_no_part():
    row = best_of({"EKF": [1.0, 2.0], "MKF": [2.0, 3.5], "HME2": [math.nan, math.nan]})
    assert (row["best"], row["runner_up"]) == ("EKF", "MKF")


def test_a_cell_without_a_common_replicate_has_no_row():
    values = values_of({"EKF": [1.0, math.nan], "MKF": [math.nan, 2.0]})
    assert find_best(values, ["EKF", "MKF"], "full", criteria=["position"]).empty


def test_one_replicate_tells_nothing_apart():
    row = best_of({"EKF": [1.0], "MKF": [5.0]})
    assert (row["best"], row["difference"]) == ("EKF", 4.0)
    assert math.isnan(row["ci_low"])
    assert math.isnan(row["ci_high"])
    assert not row["distinguishable"]


def test_one_scheme_has_no_runner_up():
    row = best_of({"MKF": [1.0, 2.0]})
    assert (row["best"], row["runner_up"], row["mse_best"]) == ("MKF", "", 1.5)
    assert row[["mse_runner_up", "difference", "ci_low", "ci_high"]].isna().all()
    assert not row["distinguishable"]


def test_a_difference_without_scatter_is_certain():
    row = best_of({"EKF": [1.0, 2.0, 3.0], "MKF": [1.5, 2.5, 3.5]})
    assert (row["ci_low"], row["ci_high"]) == (0.5, 0.5)
    assert row["distinguishable"]


ONCE = [1.0, 1.1, 0.9, 1.05]
AGAIN = [value * (1.0 - 1e-11) for value in ONCE]


def test_coinciding_schemes_count_as_one_under_the_last_name():
    worse = [value * 1.5 for value in ONCE]
    row = best_of({"EKF": AGAIN, "MKF": ONCE, "HME1": worse})
    assert (row["best"], row["runner_up"]) == ("MKF", "HME1")
    assert row["distinguishable"]
    row = best_of({"EKF": AGAIN, "MKF": ONCE, "HME1": worse}, ["MKF", "EKF", "HME1"])
    assert (row["best"], row["runner_up"]) == ("EKF", "HME1")
    row = best_of({"EKF": AGAIN, "MKF": ONCE, "HME1": [value * 0.5 for value in ONCE]})
    assert (row["best"], row["runner_up"]) == ("HME1", "MKF")


def test_schemes_coincide_only_if_every_replicate_agrees():
    swapped = [ONCE[1], ONCE[0], *ONCE[2:]]  # the same mean
    row = best_of({"EKF": ONCE, "MKF": swapped})
    assert row["best"] == "EKF"
    close = [value * (1.0 + 1e-8) for value in ONCE]
    assert best_of({"EKF": ONCE, "MKF": close})["distinguishable"]


def test_where_all_coincide_nothing_is_told_apart():
    row = best_of({"EKF": AGAIN, "MKF": ONCE})
    assert (row["best"], row["runner_up"]) == ("MKF", "EKF")
    assert not row["distinguishable"]
    assert abs(row["difference"]) < 1e-10


def test_coinciding_groups_hold_in_every_cell():
    here = values_of({"EKF": AGAIN, "MKF": ONCE, "HME1": [2.0] * 4, "HME2": [2.0] * 4})
    there = values_of(
        {"EKF": ONCE, "MKF": ONCE, "HME1": [2.0] * 4, "HME2": [2.1] * 4}, amplitude=3.0
    )
    assert coinciding(here, SCHEMES) == [("EKF", "MKF"), ("HME1", "HME2")]
    assert coinciding(pd.concat([here, there]), SCHEMES) == [("EKF", "MKF")]
    assert coinciding(here, ["HME2", "HME1", "MKF"]) == [("HME2", "HME1")]


def test_no_result_depends_on_the_order_of_rows_or_on_other_cells():
    rows = superposed_rows(replicates=11)
    shuffled = rows.sample(frac=1.0, random_state=np.random.default_rng(0))
    one, other = (tabulate(each) for each in (rows, shuffled))
    for make in (
        lambda values: make_summary(values, SCHEMES),
        lambda values: find_best(values, SCHEMES, "full"),
    ):
        pd.testing.assert_frame_equal(make(one), make(other), check_exact=True)
    alone = tabulate(rows[rows["natural_period"] == 8.0], [1.0])
    part = make_summary(one, SCHEMES).query("natural_period == 8 and amplitude == 1")
    pd.testing.assert_frame_equal(
        make_summary(alone, SCHEMES), part.reset_index(drop=True), check_exact=True
    )


def test_no_bit_of_a_mean_depends_on_how_many_replicates_others_finished():
    random = np.random.default_rng(11)
    for _ in range(5):
        own = {"EKF": list(random.lognormal(size=13))}
        others = own | {"MKF": list(random.lognormal(size=60))}
        alone = make_summary(values_of(own), ["EKF"])
        beside = make_summary(values_of(others), ["EKF", "MKF"]).head(1)
        pd.testing.assert_frame_equal(alone, beside, check_exact=True)


def test_bad_input_is_named():
    values = values_of({"EKF": [1.0, 2.0]})
    with pytest.raises(InputError, match=r"^criteria: 'speed' was not measured; use position$"):
        find_best(values, ["EKF"], "full", criteria=["speed"])
    with pytest.raises(InputError, match=r"^window: 'half' was not measured; use full$"):
        find_best(values, ["EKF"], "half", criteria=["position"])
    with pytest.raises(InputError, match=r"^rows: two values for one case"):
        make_summary(pd.concat([values, values]), ["EKF"])


@pytest.mark.parametrize("replicates", [1, 7])
def test_no_bit_depends_on_how_many_amplitudes_there_are(replicates):
    # Few amplitudes lie beside each other in another order in memory than many.
    rows = superposed_rows(replicates=replicates)
    rows.loc[rows.index[3::29], "motion"] = np.nan  # cases that have no number
    many = np.linspace(0.01, 5.0, 30).tolist()
    tables = []
    for amplitudes in (many, *([amplitude] for amplitude in many)):
        cube = Cube.of_rows(rows, SCHEMES, CONDITIONS, {"amplitude": amplitudes}, measures=MEASURES)
        tables.append(summarise(cube))
    order = list(DESIGN_SUMMARY[:5])
    one_by_one = pd.concat(tables[1:]).sort_values(order, kind="stable", ignore_index=True)
    whole = tables[0].sort_values(order, kind="stable", ignore_index=True)
    pd.testing.assert_frame_equal(whole, one_by_one, check_exact=True)
    naive = make_summary(tabulate(rows, many), SCHEMES)
    pd.testing.assert_frame_equal(tables[0], naive, check_exact=True)
