"""Decisions against a threshold, and claims about many of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    UNDECIDED,
    JudgedClaim,
    all_of,
    mean_ratio,
)


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
    assert JudgedClaim("", (one,)).verdict == JudgedClaim("", (wild,)).verdict == UNDECIDED


@pytest.mark.parametrize("size", [1.0, 1e139])
def test_a_perfect_scheme_has_a_ratio_without_a_warning(size):
    some, none = size * np.array([10.0, 11.0, 12.0]), np.zeros(3)
    assert mean_ratio("", some, none, 1.0, "above").value == np.inf
    assert mean_ratio("", none, some, 1.0, "below").value == 0.0
    assert np.isnan(mean_ratio("", none, none, 1.0, "below").value)
    assert np.isnan(mean_ratio("", some[:1], none[:1], 1.0, "above").low)
    assert mean_ratio("", some, some[::-1], 1.0, "above").value == pytest.approx(1.0)


def test_many_cells_are_corrected_by_holm():
    holds = mean_ratio("", np.array([1.0, 1.1, 0.9]), np.array([2.0, 2.2, 2.1]), 1.0, "below")
    fails = mean_ratio("", np.array([1.00, 1.30, 1.14]), np.array([0.8, 0.9, 0.9]), 1.0, "below")
    assert 0.02 < fails.p < 0.05
    assert JudgedClaim("", (fails,)).verdict == NOT_REPRODUCED
    assert JudgedClaim("", (fails, holds)).verdict == NOT_REPRODUCED
    unclear = mean_ratio("", np.array([1.0, 1.4, 0.9]), np.array([1.2, 1.1, 1.0]), 1.0, "below")
    many = JudgedClaim("", (fails, unclear, unclear, holds))
    assert many.verdict == UNDECIDED
    assert many.deciding is fails


def test_what_is_missing_can_fall_but_not_stand():
    a, b = np.array([1.0, 1.1, 0.9, 1.0]), np.array([2.0, 2.2, 2.1, 1.9])
    stands = JudgedClaim("", (mean_ratio("", a, b, 1.0, "below"),))
    lacks = JudgedClaim("", stands.decisions, ("(3 s, 2 m)",))
    falls = JudgedClaim("", (mean_ratio("", b, a, 1.0, "below"),), ("(3 s, 2 m)",))
    assert (stands.verdict, lacks.verdict, falls.verdict) == (REPRODUCED, MISSING, NOT_REPRODUCED)
    assert all_of([stands, lacks]) == MISSING
    assert all_of([stands, lacks, falls]) == NOT_REPRODUCED
    assert all_of([]) == REPRODUCED
