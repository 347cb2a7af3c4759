"""Outliers and red noise: their shares, sizes and correlations against theory."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.sensing.faults import draw_outliers
from owtsweep.sensing.noise import draw_gauss_markov
from owtsweep.streams import stream

COUNT = 200_000


def streams(*names: str) -> list[np.random.Generator]:
    return [stream(2019, "hub", (4.0,), 0, name) for name in names]


@pytest.mark.parametrize("length", [1, 8])
def test_share_and_size_of_outliers(length: int) -> None:
    drawn = draw_outliers(*streams("when", "how"), COUNT, rate=0.1, sigma=0.3, length=length)
    hit = np.any(drawn != 0.0, axis=1)
    bursts = COUNT * 0.1 / length  # independent ones
    assert hit.mean() == pytest.approx(0.1, abs=0.4 / np.sqrt(bursts))
    assert drawn[hit].std() == pytest.approx(0.3, rel=4.0 / np.sqrt(4 * bursts))
    assert np.mean(drawn[hit, 0] * drawn[hit, 1]) == pytest.approx(0.0, abs=0.4 / np.sqrt(bursts))


def test_the_fixes_of_a_burst_share_their_offset() -> None:
    drawn = draw_outliers(*streams("when", "how"), COUNT, rate=0.01, sigma=1.0, length=20)[:, 0]
    edges = np.flatnonzero(np.diff(drawn, prepend=0.0, append=0.0))
    lengths = np.diff(edges)[drawn[edges[:-1]] != 0.0]
    assert np.max(lengths) == 20
    assert np.median(lengths) == 20


def test_more_outliers_keep_those_that_were() -> None:
    few, many = (
        draw_outliers(*streams("when", "how"), 1000, rate=rate, sigma=1.0) for rate in (0.02, 0.3)
    )
    there = few != 0.0
    assert np.any(there)
    np.testing.assert_array_equal(many[there], few[there])


def test_red_noise_is_stationary_and_forgets_at_its_time_constant() -> None:
    many = np.stack([draw_gauss_markov(np.random.default_rng(k), 40, sigma=0.5, time=20.0, step=2.0)
                     for k in range(4000)])  # fmt: skip
    of_step = many.std(axis=(0, 2))
    np.testing.assert_allclose(of_step, 0.5, rtol=0.05)
    after = np.mean(many[:, 5:] * many[:, :-5]) / np.mean(many[:, 5:] ** 2)
    assert after == pytest.approx(np.exp(-10.0 / 20.0), abs=0.02)
    assert np.mean(many[..., 0] * many[..., 1]) == pytest.approx(0.0, abs=0.01)
