"""Student's t, Fieller's interval and the bootstrap against scipy and their definitions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from owtsweep.statistics.inference import (
    fieller,
    p_value,
    percentile_interval,
    resample_means,
    t_quantile,
)


def test_quantiles_are_those_of_the_t_distribution():
    freedom = np.array([[1, 5, 19], [5, 1, 0]])
    expected = stats.t.ppf(0.975, np.maximum(freedom, 1))
    np.testing.assert_allclose(t_quantile(freedom), expected, rtol=1e-12)
    assert float(t_quantile(4.5)) == pytest.approx(stats.t.ppf(0.975, 4.5))


def test_the_test_is_scipys_where_there_is_something_to_test():
    samples = np.random.default_rng(3).normal(0.3, 1.0, size=(20, 7))
    mean, error = samples.mean(axis=1), samples.std(axis=1, ddof=1) / np.sqrt(7)
    expected = stats.ttest_1samp(samples, 0.0, axis=1).pvalue
    np.testing.assert_allclose(p_value(mean, error, 6), expected, rtol=1e-9)
    value, error = np.array([0.0, 2.0, 2.0, np.nan, 1.0]), np.array([0.0, 0.0, np.nan, 1.0, np.inf])
    assert p_value(value, error, 3).tolist() == [1.0, 0.0, 1.0, 1.0, 1.0]
    assert p_value(2.0, 0.1, 0) == 1.0


def test_fieller_holds_the_ratios_that_the_paired_test_does_not_reject():
    random = np.random.default_rng(5)
    b = random.uniform(1.0, 2.0, 12)
    a = 1.5 * b + random.normal(0.0, 0.2, 12)
    low, high = fieller(a, b, float(t_quantile(11)))
    for end in (low, high):
        assert stats.ttest_1samp(a - end * b, 0.0).pvalue == pytest.approx(0.05, rel=1e-6)
    assert low < a.mean() / b.mean() < high
    assert np.isnan(fieller(a, random.normal(0.0, 1.0, 12), 2.2)).all()


def test_resampled_means_scatter_like_the_mean_and_are_the_same_again():
    records = np.random.default_rng(8).normal(size=(50, 2))
    means = resample_means(records, (4, 1))
    np.testing.assert_array_equal(means, resample_means(records, (4, 1)))
    assert not np.array_equal(means, resample_means(records, (5, 1)))
    np.testing.assert_allclose(means.std(axis=0), records.std(axis=0) / np.sqrt(50), rtol=0.05)
    low, high = percentile_interval(means[:, 0])
    assert np.mean((low <= means[:, 0]) & (means[:, 0] <= high)) == pytest.approx(0.95, abs=0.002)
    assert resample_means(records[:1], (4,)).shape == (0, 2)


def test_samples_without_order_open_both_ends():
    samples = np.concatenate([np.linspace(1.0, 2.0, 90), np.full(10, np.nan)])
    low, high = percentile_interval(samples)
    assert np.isnan(low)
    assert high == np.inf
