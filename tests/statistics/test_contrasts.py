"""Differences and ratios of two runs against known truth."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from owtsweep.statistics.contrasts import difference, gap, ratio


def samples(seed: int, n: int = 200_000) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of positive numbers with a common part, for many experiments of 8 replicates."""
    rng = np.random.default_rng(seed)
    common = rng.gamma(8.0, 1.0, size=(n // 8, 8))
    one = common + 0.5 * rng.gamma(4.0, 1.0, size=common.shape)
    other = 0.7 * common + rng.gamma(4.0, 1.0, size=common.shape)
    return one, other


@pytest.mark.parametrize("paired", [True, False])
def test_intervals_cover_the_truth_as_promised(paired):
    one, other = samples(1)
    if not paired:
        other = samples(2)[1]
    found, times = difference(one, other, paired=paired), ratio(one, other, paired=paired)
    truth = 0.7 * 8.0 + 4.0 - (8.0 + 2.0)
    cover = np.mean((found.low <= truth) & (truth <= found.high))
    assert 0.94 < cover < 0.965
    truth = (0.7 * 8.0 + 4.0) / 10.0
    assert 0.93 < np.mean((times.low <= truth) & (truth <= times.high)) < 0.965
    reference = (stats.ttest_rel if paired else stats.ttest_ind)(
        other[:9], one[:9], axis=-1, **({} if paired else {"equal_var": False})
    )
    np.testing.assert_allclose(found.p[:9], reference.pvalue, rtol=1e-9)


def test_pairing_counts_only_what_both_have_and_little_data_claims_nothing():
    one = np.array([[1.0, 2.0, np.nan, 4.0], [1.0, np.nan, np.nan, np.nan], [np.nan] * 4])
    other = np.array([[2.0, 4.0, 9.0, np.nan], [3.0, np.nan, 1.0, 1.0], [1.0] * 4])
    found = difference(one, other, paired=True)
    assert found.value[:2].tolist() == [1.5, 2.0]
    assert found.p[1:].tolist() == [1.0, 1.0]
    assert np.isnan(found.low[1:]).all()
    assert ratio(one, other, paired=True).value[0] == pytest.approx(2.0)
    thrice = ratio(one, 3.0 * one, paired=True)  # no noise is left in a ratio of equals
    assert (thrice.low[0], thrice.high[0]) == pytest.approx((3.0, 3.0), rel=1e-9)
    same = gap(np.array([[0.0, 0.0], [1.0, 1.0]]))
    assert same.p.tolist() == [1.0, 0.0]


@pytest.mark.parametrize("paired", [True, False])
def test_what_is_not_positive_or_very_large_has_no_interval_and_raises_no_warning(paired):
    one = np.array([[0.0, 0.0], [0.0, 0.0], [1e139, 2e139], [-1.0, -2.0]])
    other = np.array([[1.0, 2.0], [0.0, 0.0], [1e-139, 2e-139], [1.0, 2.0]])
    times = ratio(one, other, paired=paired)
    assert times.value.tolist()[::3] == [np.inf, -1.0]
    assert np.isnan(times.value[1])
    assert times.value[2] == pytest.approx(1e-278)
    assert np.isnan(times.low[[0, 1, 3]]).all()
    assert difference(one, other, paired=paired).value[2] == -1.5e139
