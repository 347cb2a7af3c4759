"""Few lines at many samples, against the sum itself and against the plain transform."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from owtsweep.motion.source import LEAST, SHORT, interleaved

#: Whole numbers of every kind: a default record's, a power of two, few divisors, twice a prime.
LENGTHS = [400_000, 2**17, 2 * 3 * 30_011, 2 * 99_991, 2400]


def draw(count: int) -> NDArray[np.complex128]:
    parts = np.random.default_rng(count).normal(size=(2, count))
    bins = parts[0] + 1j * parts[1]
    bins[0] = 0.0
    return bins


@pytest.mark.parametrize("samples", LENGTHS)
@pytest.mark.parametrize("last", [1, 7, 600])
def test_samples_are_those_of_the_plain_transform(samples: int, last: int) -> None:
    bins = draw(last + 1)
    rows = interleaved(bins, samples)
    assert rows.shape[1] % 2 == 0
    assert rows.size == samples
    plain = np.fft.irfft(bins, n=samples) * (samples / 2)
    assert np.max(np.abs(rows.T.reshape(-1) - plain)) < 2e-14 * np.max(np.abs(plain))


def test_samples_are_the_sum() -> None:
    bins, samples = draw(301), 20_000
    found = interleaved(bins, samples).T.reshape(-1)
    for n in (0, 1, 17, 9_999, 10_000, 19_999):
        turns = np.exp(2j * np.pi * (np.arange(301) * n % samples) / samples)
        assert found[n] == pytest.approx(np.sum(bins * turns).real, abs=1e-12)


def test_short_transforms_hold_all_lines() -> None:
    rows = interleaved(draw(2401), 400_000)
    assert SHORT * 2400 <= rows.shape[1] <= 2 * SHORT * 2400
    assert interleaved(draw(2), 400_000).shape[1] >= LEAST
    assert interleaved(draw(500), 1002).shape == (1, 1002)  # up to half the sampling rate
