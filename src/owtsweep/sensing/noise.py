"""Draws red noise (a first-order Gauss-Markov process) and a wandering bias.

A bias is made of standard normal numbers, taken from a random stream one after the other and scaled
afterwards. Therefore drawing in pieces gives the same numbers, bit for bit, as a single draw; and
with the same stream, biases of different intensity differ only in scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array


@dataclass
class WienerBias:
    """A bias that starts at a given value and wanders: a sampled Wiener process.

    The variance of the bias after the time t is walk^2 t.

    generator: the random stream of standard normal numbers. The first number is drawn but not used,
        because the first sample is `initial`.
    walk: Intensity of the Wiener process, in the unit of the measured quantity per sqrt(s).
    step: Sampling interval, s.
    initial, last: the bias of the first sample, and of the last that was drawn, if any.
    """

    generator: np.random.Generator
    walk: float
    step: float
    initial: float = 0.0
    last: float | None = None

    def draw(self, steps: int) -> Array:
        """Draw the next `steps` samples of the bias, shape (steps,)."""
        bias = self.generator.standard_normal(steps)
        if steps == 0:
            return bias
        bias *= self.walk * np.sqrt(self.step)
        bias[0] = self.initial if self.last is None else self.last + bias[0]
        np.cumsum(bias, out=bias)
        self.last = float(bias[-1])
        return bias


def draw_gauss_markov(
    generator: np.random.Generator,
    count: int,
    *,
    sigma: float,
    time: float,
    step: float,
    axes: int = 2,
) -> Array:
    """Draw samples of a first-order Gauss-Markov process on some axes, shape (count, axes).

    The axes are independent of each other. Samples that are `step` (s) apart have the correlation
    exp(-step / time) (Bar-Shalom, Li and Kirubarajan 2001, section 8.2). The process is stationary
    from its first sample on. `sigma` is the standard deviation of a sample along each axis, in its
    unit.
    """
    from scipy.signal import lfilter

    memory = np.exp(-step / time)
    driving = generator.standard_normal((count, axes))
    driving[1:] *= np.sqrt(-np.expm1(-2.0 * step / time))
    return np.asarray(sigma * lfilter([1.0], [1.0, -memory], driving, axis=0))
