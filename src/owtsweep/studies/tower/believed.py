"""What schemes believe of the unknown loads: the tuning's numbers, or statistics of the truth."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.tower.contract import Believed
from owtsweep.studies.tower.truth import Motion
from owtsweep.studies.tower.tuning import Tuning

#: With inputs=truth, a load changes at least by this part of the tuning's number per step, because
#: a filter cannot be made for a load without any change.
LEAST = 1e-3


def make_believed(tuning: Tuning, step: float, motion: Motion | None) -> Believed:
    """Return what a tuning says about the five loads of one direction.

    With declared numbers, a load is a random walk with these steps; as a latent force, it is the
    exponentially correlated process with the tuning's correlation time and, for short times, the
    walk's growth: sigma^2 = step_sigma^2 length / (2 step).

    Parameters
    ----------
    tuning
        The section `filters`.
    step
        Sampling interval in s.
    motion
        The truth of the direction; read only if the tuning takes numbers from the truth. None
        stands for a truth that is not known yet: the declared numbers hold.
    """
    change = np.array([tuning.force, tuning.moment] * 2 + [tuning.wave])
    length = np.full(5, tuning.correlation_time)
    if tuning.inputs == "declared" or motion is None:
        return Believed(change, change * np.sqrt(length / (2.0 * step)), length)
    loads = np.column_stack([motion.inputs, motion.wave])
    known = np.isfinite(loads).all(axis=0)  # a record may lack loads: the tuning's numbers hold
    loads = np.where(known, loads, 0.0)
    moving = np.any(loads != 0.0, axis=0)
    seen = np.std(np.diff(loads, axis=0), axis=0)
    size = np.sqrt(np.mean(np.square(loads), axis=0))
    least = LEAST * change
    return Believed(
        step_sigma=np.where(known, np.maximum(seen, least), change),
        sigma=np.where(known, np.maximum(size, least), change * np.sqrt(length / (2.0 * step))),
        length=np.where(moving, _correlate(loads, step), length),
    )


def _correlate(loads: Array, step: float) -> Array:
    """Return the times (s) at which the correlations of the columns have fallen to 1/e."""
    steps = len(loads)
    spectrum = np.abs(np.fft.rfft(loads - loads.mean(axis=0), 2 * steps, axis=0)) ** 2
    correlation = np.fft.irfft(spectrum, axis=0)[:steps]
    fallen = correlation < np.exp(-1.0) * correlation[0]
    return np.asarray(step * np.maximum(np.argmax(fallen, axis=0), 1))
