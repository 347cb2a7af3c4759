"""Makes the rows of the hub study: MSE (Eq. 12 of Ren et al. 2019), NEES and NIS.

Each measure is taken in two windows: over the whole record, and after the settling time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import PLANAR_MOTION
from owtsweep.evaluation.measures import Errors, Mean, measure
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.batch import Sums

#: The measures that the kernels sum, in their order.
SUMMED = ("x", "y", "vx", "vy", "nees", "nis")
#: Measures of the position error that need records run at their amplitude.
EXTREMES = ("position_max", "position_p95")
WINDOWS = ("full", "settled")

#: Name of a column -> its values: numbers or strings.
Columns = dict[str, Array | NDArray[np.int64] | list[str]]
#: The columns of a shard (a stored file of rows), in order.
COLUMNS = (
    "natural_period", "replicate", "scheme", "measure", "window", "amplitude", "motion", "cross",
    "noise", "value", "n_samples", "status", "reason",
)  # fmt: skip


class Measured(NamedTuple):
    """The measures of some records.

    Attributes
    ----------
    measures, windows
        Names of measure and window, n each.
    products
        Means of motion x motion, motion x noise and noise x noise, shape (n, 3, records).
    n_samples
        Number of samples in each mean, n numbers.
    """

    measures: list[str]
    windows: list[str]
    products: Array
    n_samples: list[int]


def from_sums(sums: Sums, chosen: slice | Sequence[int] = slice(None)) -> Measured:
    """Compute the measures of replicates from the kernels' sums.

    `chosen` are the indices of the replicates in the sums; by default all.
    """
    names = [*SUMMED, "position", "velocity", *(EXTREMES if len(sums.squared) else ())]
    # from here on the first axis is the window: the whole record, then the settled part
    steps, covariances, innovations = (
        np.array([sum(n), n[1]]) for n in (sums.steps, sums.covariances, sums.innovations)
    )
    of_name = {"nees": covariances, "nis": innovations}
    counts = np.stack([of_name.get(name, steps) for name in names], axis=1)
    products = sums.products[..., chosen]
    totals = np.stack([products.sum(axis=0), products[1]])
    means = totals / np.maximum(counts[:, : totals.shape[1]], 1)[..., None, None]
    x, y, vx, vy = means.swapaxes(0, 1)[:4]
    parts = [means, np.stack([x + y, vx + vy], axis=1)]
    if len(sums.squared):
        squared = (sums.squared[first:, chosen] for first in (0, int(sums.steps[0])))
        parts.append(np.stack([_extremes(errors) for errors in squared]))
    # A scheme may state no covariance; and no innovation if no fix comes after the settling time.
    there = counts > 0
    entries = [(name, window) for window in WINDOWS for name in names]
    measures, windows = zip(*(entries[i] for i in np.flatnonzero(there)), strict=True)
    values = np.concatenate(parts, axis=1)[there]
    return Measured(list(measures), list(windows), values, counts[there].tolist())


def _extremes(squared: Array) -> Array:
    """Compute the largest error and the 95th percentile from squared errors (steps, records).

    The result has the shape (2, 3, records): measures, products, records. Only product 2, noise x
    noise, is set; the others are zero.
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
) -> Measured:
    """Compute the measures of a record that was run step by step.

    Parameters
    ----------
    motion
        The response to the motion of unit amplitude alone; None if `noise` is the response to the
        whole series (motion plus noise).
    noise
        The response to noise alone, or to the whole series.
    truth
        True state of the motion, shape (steps, 4): x, y, v_x, v_y.
    settled
        The first settled step.
    extremes
        Whether to compute `EXTREMES` too; only for whole series.
    """
    parts = [noise] if motion is None else [motion, noise]
    innovation = [part.innovation for part in parts if part.innovation is not None]
    errors = Errors(
        [parts[0].state - truth, *(part.state for part in parts[1:])],
        noise.covariance,
        innovation,
        noise.innovation_covariance,
    )
    entries = []
    for window, start in zip(WINDOWS, (0, settled), strict=True):
        means = measure(errors, PLANAR_MOTION, start)
        if extremes and motion is None:
            squared = np.sum(errors.state[0][start:, :2] ** 2, axis=1)[:, None]
            values = zip(EXTREMES, _extremes(squared)[..., 0], strict=True)
            means |= {name: Mean(value, len(squared)) for name, value in values}
        for name, (mean, count) in means.items():
            entries.append((name, window, mean[:, None], count))
    names, windows, products, counts = zip(*entries, strict=True)
    return Measured(list(names), list(windows), np.stack(products), list(counts))


def table(
    natural_period: float,
    replicates: Sequence[int],
    scheme: str,
    measured: Measured,
    amplitude: float | None,
) -> Columns:
    """Make the rows of some records of a scheme, record by record, as columns.

    Parameters
    ----------
    natural_period
        Natural period, s.
    replicates
        Numbers of the records in `measured`.
    amplitude
        Amplitude at which the records were run, m; the column `value` is then the product noise x
        noise. None for superposed records, which have all three products and no value.
    """
    measures, windows, means, samples = measured
    records, rows = len(replicates), len(measures) * len(replicates)
    products = means.transpose(1, 2, 0).reshape(3, rows)
    at, value = np.full((2, rows), np.nan)
    if amplitude is not None:
        at, value, products = np.full(rows, amplitude), products[2], np.full((3, rows), np.nan)
    return {
        "natural_period": np.full(rows, natural_period),
        "replicate": np.repeat(np.array(replicates, dtype=np.int64), len(measures)),
        "scheme": [scheme] * rows,
        "measure": measures * records,
        "window": windows * records,
        "amplitude": at,
        "motion": products[0],
        "cross": products[1],
        "noise": products[2],
        "value": value,
        "n_samples": np.tile(np.array(samples, dtype=np.int64), records),
        "status": ["ok"] * rows,
        "reason": [""] * rows,
    }


def failed(
    natural_period: float, replicate: int, scheme: str, reason: str, amplitude: float | None
) -> Columns:
    """Make the single row of a failed case, as columns."""
    nothing = Measured([""], [""], np.full((1, 3, 1), np.nan), [0])
    row = table(natural_period, [replicate], scheme, nothing, amplitude)
    return {**row, "status": ["failed"], "reason": [reason]}
