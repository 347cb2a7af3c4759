"""Losses: how many and how long, against theory."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.sensing.faults import draw_losses
from owtsweep.streams import stream

COUNT = 200_000


def uniforms() -> np.random.Generator:
    return stream(2019, "hub", (4.0,), 0, "loss")


@pytest.mark.parametrize("length", [1, 5, 40])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.6])
def test_the_share_that_is_lost(share: float, length: int) -> None:
    lost = draw_losses(uniforms(), COUNT, 1 - (1 - share) ** (1 / length), length)
    # samples `length` apart are independent, so the mean has at least COUNT / length of them
    spread = np.sqrt(share * (1 - share) * 2 * length / COUNT)
    assert lost.mean() == pytest.approx(share, abs=5 * spread + 1e-12)


def test_single_losses_are_independent() -> None:
    lost = draw_losses(uniforms(), COUNT, 0.3)
    both = np.mean(lost[1:] & lost[:-1])
    assert both == pytest.approx(0.09, abs=5 * np.sqrt(0.09 / COUNT))


def test_outages_last_their_length() -> None:
    lost = draw_losses(uniforms(), COUNT, 1e-4, 25)  # rare: hardly any two meet
    edges = np.flatnonzero(np.diff(np.concatenate([[0], lost, [0]]).astype(int)))
    lengths = edges[1::2] - edges[::2]
    assert np.all(lengths[:-1] >= 25)
    assert np.median(lengths) == 25


def test_more_losses_keep_those_that_were() -> None:
    few = draw_losses(uniforms(), 1000, 0.05, 3)
    assert np.all(draw_losses(uniforms(), 1000, 0.1, 3)[few])
    assert np.all(draw_losses(uniforms(), 1000, 0.05, 9)[few])
