"""Models the loss of samples: one by one, or in outages of a given length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.errors import InputError


@dataclass
class Losses:
    """The losses of a sensor's samples, drawn piece by piece.

    At each sample an outage begins with the same probability, independently of other samples. It
    may begin inside another outage, too. No outage begins before the first sample. With a length of
    1, each sample is lost independently of the others. In the long run the share 1 - (1 -
    probability)^length of samples is lost. If the probability or the length is raised, and the
    random stream is the same, all samples that were lost before are lost again, and others may be
    lost too.

    Attributes
    ----------
    generator
        The random stream, from which one uniform number per sample is drawn.
    probability
        Probability that an outage begins at a sample.
    length
        Length of an outage in samples.
    remaining
        Number of samples for which the present outage continues.

    Raises
    ------
    InputError
        If the probability is not between 0 and 1, or the length is less than 1.
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
        """Draw which of the next `count` samples are lost; return a mask of shape (count,)."""
        begins = self.generator.random(count) < self.probability
        sample = np.arange(count)
        last = np.maximum.accumulate(np.where(begins, sample, -self.length))
        lost = (sample - last < self.length) | (sample < self.remaining)
        newest = last[-1] + self.length - count if count else 0
        self.remaining = max(self.remaining - count, int(newest), 0)
        return lost
