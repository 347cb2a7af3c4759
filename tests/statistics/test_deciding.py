"""Looks at more and more records: who leaves, who wins, what is a tie, how often it is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import skew, t, ttest_1samp

from experiments.deciding import (
    CELLS,
    decide_all,
    draw_lognormal,
    draw_skewed,
    examine_printed,
    find_faults,
    find_fixed_designs,
    resample,
    simulate,
)
from owtsweep.statistics.deciding import (
    LEVEL,
    LOOKS,
    Decision,
    Rule,
    decide,
    find_level,
    is_below,
)

RULE = Rule()


def follow_looks(values, rule, cells, run=None) -> list[Decision]:
    """Return what is known after each look, to the last one."""
    found = (
        decide(values[:, :records], rule, cells, None if run is None else run[:, :records])
        for records in LOOKS
        if records <= values.shape[1]
    )
    return [look for look in dict.fromkeys(found) if look.look > 0]


def test_levels_of_all_looks_are_the_level_of_the_map() -> None:
    levels = [find_level(look) for look in range(1, 200_000)]
    assert sum(levels) == pytest.approx(LEVEL, rel=1e-4)
    assert sum(levels) < LEVEL
    assert LOOKS[:6] == (8, 16, 32, 64, 128, 256)


def test_the_test_is_student_s_and_hall_s() -> None:
    random = np.random.default_rng(3)
    few = random.normal(-0.6, 1.0, (50, 12))
    p = ttest_1samp(few, 0.0, axis=1, alternative="less").pvalue
    np.testing.assert_array_equal(is_below(few, 0.01), p < 0.01)
    many = random.gamma(4.0, 0.25, (200, 40)) - 1.2  # of mean -.2, skewness 1
    n, S, g = 40, many.mean(1) / many.std(1, ddof=1), skew(many, axis=1)
    g = g * (many.std(1) / many.std(1, ddof=1)) ** 3
    hall = np.sqrt(n) * (S + g * S**2 / 3 + g**2 * S**3 / 27 + g / (6 * n))
    statistic = np.where(np.abs(g) > 1.0, hall, np.sqrt(n) * S)
    np.testing.assert_array_equal(is_below(many, 0.02), statistic < t.ppf(0.02, n - 1))
    for samples, value in zip(many[:40], statistic, strict=False):  # each at its own level
        p_value = t.cdf(value, n - 1)
        found = [bool(is_below(samples, p_value * part)) for part in (1.0 - 1e-6, 1.0 + 1e-6)]
        assert found == [False, True]
    assert 0 < np.sum(np.abs(g) > 1.0) < 200
    equal = np.array([[-1.0] * 8, [0.0] * 8, [2.0] * 8])
    assert is_below(equal, 0.05).tolist() == [True, False, False]


def test_who_is_clearly_better_wins_at_the_first_look() -> None:
    random = np.random.default_rng(1)
    values = random.gamma(5.0, size=(1, 64)) * np.array([[9.0], [1.0], [4.0]])
    found = decide(values, RULE, 60)
    assert (found.verdict, found.best, found.left, found.look, found.records) == (
        "won", 1, (1,), 1, 8,
    )  # fmt: skip


def test_equally_good_contenders_are_a_tie_for_the_simplest_but_not_before_32_records() -> None:
    random = np.random.default_rng(2)
    shared = random.gamma(5.0, size=256)
    values = shared * np.exp(random.normal(0.0, 0.002, (3, 256)))
    looks = follow_looks(values, RULE, 60)
    assert [look.verdict for look in looks] == ["open", "open", "tie"]
    assert looks[-1].best == 0
    early = follow_looks(values, RULE._replace(ties_from=16), 60)
    assert [look.verdict for look in early] == ["open", "tie"]
    # 8 % worse by the error is more than the margin, by the square it is less
    worse = values * np.array([[1.08], [1.0], [1.0]])
    assert decide(worse, RULE._replace(ties_from=8), 60).best == 0
    assert decide(worse, RULE._replace(ties_from=8, squared=False), 60).best != 0
    assert decide(worse, RULE._replace(ties_from=8, squared=False, floor=9.0), 60).best == 0


def test_a_contender_that_fails_leaves_and_all_may_fail() -> None:
    values = np.ones((2, 40)) * np.array([[1.0], [2.0]])
    values[0, 20] = np.nan
    values[:, :20] = np.random.default_rng(4).gamma(1.0, size=(2, 20))
    looks = follow_looks(values, RULE, 60)
    assert looks[2].verdict == "won"
    assert looks[2].best == 1
    assert decide(np.full((2, 8), np.nan), RULE, 1).verdict == "none"
    assert decide(np.ones((2, 7)), RULE, 1)[:4] == ("open", -1, (0, 1), 0)


def test_more_records_continue_a_contest_and_change_no_decision() -> None:
    random = np.random.default_rng(5)
    for _ in range(50):
        values = draw_lognormal(random, 512, 0.2).values
        short = follow_looks(values[:, :128], RULE._replace(most=128), CELLS)
        long = follow_looks(values, RULE._replace(most=512), CELLS)
        assert long[: len(short)] == short
        seen = decide(values[:, : long[-1].records], RULE._replace(most=512), CELLS)
        assert seen == long[-1]


def test_contenders_that_coincide_count_as_one_named_by_the_simplest() -> None:
    one = np.random.default_rng(8).gamma(5.0, size=64)
    found = decide(np.stack([one, one * (1.0 + 1e-12), 40.0 * one]), RULE, 6)
    assert (found.verdict, found.best, found.left, found.look) == ("won", 0, (0, 1), 1)


def test_there_is_no_look_at_records_that_were_not_run() -> None:
    values = np.random.default_rng(7).gamma(5.0, size=(2, 32))
    run = np.ones((2, 32), dtype=bool)
    run[1, 12] = False
    looks = follow_looks(values, RULE, 60, run)
    assert [look.records for look in looks] == [8]


@pytest.mark.parametrize("most", [0, 7, 100])
def test_most_records_are_those_of_a_look(most: int) -> None:
    with pytest.raises(ValueError, match=f"most: {most} is not the number of records of a look"):
        decide(np.ones((2, 8)), RULE._replace(most=most), 1)


def test_maps_are_seldom_wrong() -> None:
    """A small form of experiments/deciding.py; with 40 maps, two wrong ones are no chance."""
    random = np.random.default_rng(6)
    for draw, allowed in (
        (lambda: draw_lognormal(random, 256, 0.15), 2),
        (lambda: draw_skewed(random, 256), 4),
    ):
        cells = [draw() for _ in range(40 * 12)]
        found = decide_all(np.stack([cell.values for cell in cells]), RULE, 12)
        faults = [
            bool(find_faults(verdict, cell.means, best, RULE))
            for verdict, best, cell in zip(found.verdict, found.best, cells, strict=True)
        ]
        assert np.reshape(faults, (40, 12)).any(axis=1).sum() <= allowed


@pytest.mark.parametrize("rule", [RULE, Rule(squared=False, floor=0.1, ties_from=16, most=128)])
def test_the_experiment_decides_many_cells_as_the_rule_decides_each(rule: Rule) -> None:
    random = np.random.default_rng(7)
    draws = [*[lambda sd=sd: draw_lognormal(random, 256, sd) for sd in (0.05, 0.15, 0.4)]]
    draws.append(lambda: draw_skewed(random, 256))
    values = np.stack([draw().values for draw in draws for _ in range(30)])
    found = decide_all(values, rule, CELLS)
    each = [decide(cell, rule, CELLS) for cell in values]
    assert {"won", "tie", "open"} == {*found.verdict}
    assert found.verdict.tolist() == [one.verdict for one in each]
    assert found.best.tolist() == [one.best for one in each]
    assert found.stop.tolist() == [one.records for one in each]
    for cell, runs in zip(values, found.runs, strict=True):
        looks = follow_looks(cell, rule, CELLS)
        assert runs == sum(
            next((look.records for look in looks if i not in look.left), looks[-1].records)
            for i in range(len(cell))
        )


def test_a_printed_error_is_examined_at_the_look_that_decided() -> None:
    """The deciding records of one scheme are 10 % too good; later ones are right on average."""
    random = np.random.default_rng(8)
    values = random.gamma(50.0, 1.0 / 50.0, (200, 2, 64)) * np.array([[1.0], [4.0]])
    values[:, 0, :8] *= 0.9**2
    rule = RULE._replace(most=32)
    found = decide_all(values, rule, CELLS)
    assert {*found.stop} == {8}
    seen = examine_printed(values, np.tile([1.0, 4.0], (200, 1)), found, rule).mean()
    assert seen["bias"] == pytest.approx(-0.1, abs=0.01)
    assert abs(seen["bias_fresh"]) < 0.01
    assert seen["coverage"] < 0.3 < 0.9 < seen["coverage_fresh"]


def test_a_fixed_design_grows_with_the_share_that_it_is_to_decide() -> None:
    values = np.random.default_rng(9).gamma(5.0, size=(2, 128)) * np.array([[1.0], [1.2]])
    none, half, most = find_fixed_designs([resample(values)], RULE, (0.0, 0.5, 0.9), cells=40)
    assert none == 8
    assert 32 < half < most < 1000
    equal, exact = resample(np.stack([values[0], values[0, ::-1]])), RULE._replace(margin=0.0)
    assert np.isnan(find_fixed_designs([equal], exact, (0.9,), cells=4)).all()
    whole = simulate([resample(values)], RULE, maps=2)
    assert whole["won"] + whole["tied"] + whole["open"] == pytest.approx(1.0)
    assert whole["false_wins"] == 0.0
    assert 32 < whole["records"] <= 256
