"""Draws which samples of a sensor are lost, and which are outliers; one by one, or in bursts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require


@dataclass
class Losses:
    """The losses of a sensor's samples, drawn piece by piece.

    At each sample an outage begins with the same probability, independently of others, perhaps
    inside another outage; none begins before the first sample. In the long run the share 1 - (1 -
    probability)^length of samples is lost. If probability or length is raised, and the random
    stream is the same, all samples that were lost before are lost again. Raise `InputError` if the
    probability is not between 0 and 1, or the length is less than 1.

    `generator`: the random stream, from which one uniform number per sample is drawn.
    `probability`: probability that an outage begins at a sample. `length`, `remaining`: length of
    an outage, and what remains of the present one, in samples.
    """

    generator: np.random.Generator
    probability: float
    length: int = 1
    remaining: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.probability <= 1.0:
            raise InputError(f"probability: {self.probability:g} is not between 0 and 1")
        if self.length < 1:
            raise InputError(f"length: an outage of {self.length} samples; give 1 or more")

    def draw(self, count: int) -> NDArray[np.bool_]:
        """Return a mask (count,) of which of the next `count` samples are lost."""
        begins = self.generator.random(count) < self.probability
        sample = np.arange(count)
        last = np.maximum.accumulate(np.where(begins, sample, -self.length))
        lost = (sample - last < self.length) | (sample < self.remaining)
        newest = last[-1] + self.length - count if count else 0
        self.remaining = max(self.remaining - count, int(newest), 0)
        return lost


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
    others. The offsets scale with `sigma`. Raise `InputError` if the rate is not from 0 to 0.5,
    sigma is negative, or the length is less than 1.

    begins, offsets: Random streams: of the moments at which bursts begin (one uniform number per
        sample), and of the offsets (a normal number per sample and axis).
    rate: Share of the samples that are outliers, in the long run.
    sigma: Standard deviation of an offset along each axis, in the unit of the samples.
    length: Number of samples of a burst.
    """
    require(0.0 <= rate <= 0.5, f"rate: {rate:g} is not from 0 to 0.5, a share of all samples")
    require(sigma >= 0.0, f"sigma: {sigma:g} is no standard deviation; give 0 or more")
    require(length >= 1, f"length: a burst of {length} samples; give 1 or more")
    # no outlier at a sample: no burst began at this sample, nor at the length - 1 samples before
    probability = 1.0 - (1.0 - rate) ** (1.0 / length)
    starts = begins.random(count) < probability
    drawn = sigma * offsets.standard_normal((count, axes))
    sample = np.arange(count)
    last = np.maximum.accumulate(np.where(starts, sample, -length))
    return np.where((sample - last < length)[:, None], drawn[np.maximum(last, 0)], 0.0)
