"""Draws red noise: a stationary first-order Gauss-Markov process."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require


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

    The axes are independent of each other. Samples that are `step` apart have the correlation
    exp(-step / time) (Bar-Shalom, Li and Kirubarajan 2001, section 8.2). The process is stationary
    from its first sample on.

    Parameters
    ----------
    generator
        The random stream, from which a standard normal number per sample and axis is drawn.
    sigma
        Standard deviation of a sample along each axis, in the unit of the samples.
    time
        Time constant, s.
    step
        Sampling interval, s.
    axes
        Number of axes.

    Raises
    ------
    InputError
        If sigma is negative, or the time constant or the interval is not positive.
    """
    from scipy.signal import lfilter

    require(sigma >= 0.0, f"sigma: {sigma:g} is no standard deviation; give 0 or more")
    require(time > 0.0, f"time: {time:g} s is no time constant; give more than 0")
    require(step > 0.0, f"step: {step:g} s is no interval; give more than 0")
    memory = np.exp(-step / time)
    driving = generator.standard_normal((count, axes))
    driving[1:] *= np.sqrt(-np.expm1(-2.0 * step / time))
    return np.asarray(sigma * lfilter([1.0], [1.0, -memory], driving, axis=0))
