"""Makes the rows of the hub study: MSE (Eq. 12 of Ren et al. 2019), NEES and NIS."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.measures import Mean, measure
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.results.criteria import MILLIMETRE, MILLIMETRE_PER_SECOND, Criterion
from owtsweep.studies.base.declaration import Means
from owtsweep.studies.hub.config import HubConfig

#: The measures that the kernels sum, in their order.
SUMMED = ("x", "y", "vx", "vy", "nees", "nis")
#: Measures of the position error that need records run at their amplitude.
EXTREMES = ("position_max", "position_p95")
WINDOWS = ("full", "settled")
#: The order of measures in tables.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: The measures that decide whether two schemes coincide.
CRITERIA = ("position", "velocity")
#: The measures by which schemes may be judged.
JUDGED = {
    "position": Criterion("position: rms error in the plane", "square", "m", *MILLIMETRE),
    "velocity": Criterion(
        "velocity: rms error in the plane", "square", "m/s", *MILLIMETRE_PER_SECOND
    ),
    "x": Criterion("position northwards: rms error", "square", "m", *MILLIMETRE),
    "y": Criterion("position eastwards: rms error", "square", "m", *MILLIMETRE),
}


def criteria(config: HubConfig) -> tuple[str, ...]:
    """Return the measures of best_scheme.csv: position, velocity and the run's criterion."""
    return tuple(dict.fromkeys((*CRITERIA, config.measures.criterion)))


class Sums(NamedTuple):
    """The sums of one scheme's squared errors over each record, and the numbers of summed terms.

    The error of an estimate is the error from motion plus the error from noise.

    products: sums over the steps, shape (2, 6, 3, replicates). The axes are: steps before and after
        the settling time; x, y, vx, vy, NEES, NIS; products of the errors from motion x motion,
        motion x noise, noise x noise. SI units.
    steps, covariances, innovations: numbers of steps, of stated covariances and of innovations,
        before and after the settling time, shape (2,) each.
    squared: squared position error of each step, m^2, shape (steps, replicates), or (0, replicates)
        without `keep_squared`.
    """

    products: Array
    steps: NDArray[np.int64]
    covariances: NDArray[np.int64]
    innovations: NDArray[np.int64]
    squared: Array


def join_sums(
    parts: Sequence[tuple[Array, Array]],
    settled: int,
    steps: int,
    count_innovations: Callable[[int], int],
    has_covariance: bool = True,
) -> Sums:
    """Join `products` and `squared` of some records each to the `Sums` of all of them.

    `count_innovations` returns the number of innovations before a step; records have `steps` steps,
    of which `settled` is the first after the settling time.
    """
    products, squared = (np.concatenate(arrays, axis=-1) for arrays in zip(*parts, strict=True))
    lengths = np.array([settled, steps - settled])
    early = count_innovations(settled)
    return Sums(
        products,
        lengths,
        lengths if has_covariance else np.zeros_like(lengths),
        np.array([early, count_innovations(steps) - early]),
        squared,
    )


def from_sums(sums: Sums) -> list[Means]:
    """Compute the measures of each record from a scheme's sums of squared errors."""
    names = [*SUMMED, "position", "velocity", *(EXTREMES if len(sums.squared) else ())]
    # from here on the first axis is the window: the whole record, then the settled part
    steps, covariances, innovations = (
        np.array([sum(n), n[1]]) for n in (sums.steps, sums.covariances, sums.innovations)
    )
    of_name = {"nees": covariances, "nis": innovations}
    counts = np.stack([of_name.get(name, steps) for name in names], axis=1)
    totals = np.stack([sums.products.sum(axis=0), sums.products[1]])
    means = totals / np.maximum(counts[:, : totals.shape[1]], 1)[..., None, None]
    x, y, vx, vy = means.swapaxes(0, 1)[:4]
    parts = [means, np.stack([x + y, vx + vy], axis=1)]
    if len(sums.squared):
        squared = (sums.squared[first:] for first in (0, int(sums.steps[0])))
        parts.append(np.stack([_extremes(errors) for errors in squared]))
    # A scheme may state no covariance; and no innovation if no fix comes after the settling time.
    there = counts > 0
    entries = [(name, window) for window in WINDOWS for name in names]
    measures, windows = zip(*(entries[i] for i in np.flatnonzero(there)), strict=True)
    values = np.concatenate(parts, axis=1)[there]
    samples = counts[there].tolist()
    return [Means(measures, windows, of_record, samples) for of_record in np.moveaxis(values, 2, 0)]


def _extremes(squared: Array) -> Array:
    """Compute largest error and 95th percentile of the error from squared errors (steps, records).

    The result has the shape (2, 3, records): the two measures, the three products of `Means`, of
    which only noise x noise is not zero, the records.
    """
    error = np.sqrt(squared)
    result = np.zeros((2, 3, error.shape[1]))
    result[0, 2] = np.max(error, axis=0)
    result[1, 2] = np.percentile(error, 95.0, axis=0)
    return result


def from_trajectories(
    motion: Trajectory | None,
    noise: Trajectory,
    truth: Array,
    settled: int,
    *,
    extremes: bool = False,
) -> Means:
    """Compute the measures of one record from the estimates of a scheme at each step.

    motion: the response to the motion of unit amplitude alone; None if `noise` is the response to
        the whole series (motion plus noise).
    noise: the response to noise alone, or to the whole series.
    truth: true state of the motion, shape (steps, 4): x, y, v_x, v_y.
    settled: number of the first step after the settling time.
    extremes: whether to compute `EXTREMES` too; this has no effect unless `motion` is None.
    """
    moved, *others = [noise] if motion is None else [motion, noise]
    errors = [moved._replace(state=moved.state - truth), *others]
    entries = []
    for window, start in zip(WINDOWS, (0, settled), strict=True):
        means = measure(errors, start)
        if extremes and motion is None:
            squared = np.sum(errors[0].state[start:, :2] ** 2, axis=1)[:, None]
            values = zip(EXTREMES, _extremes(squared)[..., 0], strict=True)
            means |= {name: Mean(value, len(squared)) for name, value in values}
        for name, (mean, count) in means.items():
            entries.append((name, window, mean, count))
    names, windows, products, counts = zip(*entries, strict=True)
    return Means(names, windows, np.stack(products), counts)
