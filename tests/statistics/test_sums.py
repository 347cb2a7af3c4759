"""Ordered sums and means against NumPy, and no bit that depends on anything else."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.statistics.inference import mean_and_error, ordered_sum


def test_a_scheme_that_diverges_has_an_open_interval(recwarn):
    mean, error, n = mean_and_error(np.array([[1e170, 2e170, 6e170], [1.0, 2.0, 3.0]]))
    assert mean.tolist() == pytest.approx([3e170, 2.0])
    assert error[0] == np.inf
    assert error[1] == pytest.approx(3**-0.5)
    assert n.tolist() == [3, 3]
    assert not recwarn.list


def test_no_bit_of_a_sum_depends_on_how_samples_lie_in_memory():
    samples = np.random.default_rng(1).lognormal(size=(7, 3, 40))
    naive = np.zeros((7, 3))
    for place in range(40):
        naive += samples[..., place]
    beside = np.asfortranarray(samples)
    for layout in (samples, beside, samples.transpose(1, 0, 2).copy().transpose(1, 0, 2)):
        np.testing.assert_array_equal(ordered_sum(layout), naive)
    np.testing.assert_array_equal(ordered_sum(samples[2, 1]), naive[2, 1])


def test_mean_and_error_leave_out_what_is_missing():
    samples = np.array([[1.0, np.nan, 2.0, 6.0], [np.nan, 4.0, np.nan, np.nan]])
    mean, error, n = mean_and_error(samples)
    assert mean.tolist() == [3.0, 4.0]
    assert error[0] == pytest.approx(np.std([1.0, 2.0, 6.0], ddof=1) / np.sqrt(3))
    assert np.isnan(error[1])
    assert n.tolist() == [3, 1]
