"""Draws which samples of a sensor are lost, and which are outliers; holds the last that came."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array


def draw_losses(
    generator: np.random.Generator, count: int, probability: float, length: int = 1
) -> NDArray[np.bool_]:
    """Draw which of a sensor's samples are lost, a mask of the shape (count,).

    At each sample an outage begins with the same probability, independently of others, perhaps
    inside another outage; none begins before the first sample. In the long run the share 1 - (1 -
    probability)^length of samples is lost. If probability or length is raised, and the random
    stream is the same, all samples that were lost before are lost again.

    `generator`: the random stream, from which one uniform number per sample is drawn.
    `probability`: probability that an outage begins at a sample. `length`: of an outage, in
    samples.
    """
    return _find_bursts(generator.random(count) < probability, length)[0]


def _find_bursts(
    begins: NDArray[np.bool_], length: int
) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Return which samples are in a burst of some samples, and where the newest burst begins."""
    sample = np.arange(len(begins))
    last = np.maximum.accumulate(np.where(begins, sample, -length))
    return sample - last < length, np.maximum(last, 0)


def hold_last(values: Array, given: Array | float) -> Array:
    """Return a sensor's samples (steps, ...) in which those with a NaN are the ones before.

    `given` stands before the first one.
    """
    lost = np.isnan(values).reshape(len(values), -1).any(axis=1)
    last = np.maximum.accumulate(np.where(lost, -1, np.arange(len(values))))
    held = values[np.maximum(last, 0)]
    held[last < 0] = given
    return held


def draw_outliers(
    begins: np.random.Generator,
    offsets: np.random.Generator,
    count: int,
    *,
    rate: float,
    sigma: float,
    length: int = 1,
    axes: int = 2,
) -> Array:
    """Draw what outliers add to a sensor's samples on some axes, shape (count, axes).

    The samples of a burst share one offset, as by a reflected signal (multipath). At each sample a
    burst begins with the same probability; a burst that begins inside another one goes on with its
    own offset. Samples outside of bursts get zero. With a length of 1, the errors of a sensor with
    white noise are then those of a contaminated normal distribution (Huber 1964).

    Raising the rate, with the same random streams, keeps the bursts that were there, and adds
    others. The offsets scale with `sigma`.

    begins, offsets: Random streams: of the moments at which bursts begin (one uniform number per
        sample), and of the offsets (a normal number per sample and axis).
    rate: Share of the samples that are outliers, in the long run.
    sigma: Standard deviation of an offset along each axis, in the unit of the samples.
    length: Number of samples of a burst.
    """
    probability = 1.0 - (1.0 - rate) ** (1.0 / length)
    starts = begins.random(count) < probability
    drawn = sigma * offsets.standard_normal((count, axes))
    inside, start = _find_bursts(starts, length)
    return np.where(inside[:, None], drawn[start], 0.0)
