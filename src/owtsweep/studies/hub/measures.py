"""Makes the rows of the hub study: MSE (Eq. 12 of Ren et al. 2019), NEES and NIS.

Each measure is computed in two time windows: the whole record, and the part after the settling
time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import PLANAR_MOTION
from owtsweep.evaluation.measures import Errors, Mean, measure
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.results.conditions import Value
from owtsweep.studies.hub.batch import Sums

#: The measures that the kernels sum, in their order.
SUMMED = ("x", "y", "vx", "vy", "nees", "nis")
#: Measures of the position error that need records run at their amplitude.
EXTREMES = ("position_max", "position_p95")
WINDOWS = ("full", "settled")

#: The values of a column: numbers or strings.
Column = Array | NDArray[np.int64] | list[str]
#: Name of a column -> its values.
Columns = dict[str, Column]
#: The columns of a shard (a stored file of rows) with motion=spectrum, in order. With motion=plant
#: the plant's conditions take the place of the natural period.
COLUMNS = (
    "natural_period", "replicate", "scheme", "measure", "window", "amplitude", "motion", "cross",
    "noise", "value", "n_samples", "status", "reason",
)  # fmt: skip


class Measured(NamedTuple):
    """The measures of some records: n pairs of a measure and a time window.

    Attributes
    ----------
    measures, windows
        Name of the measure and name of the window, n entries each.
    products
        Means over the window of three products, shape (n, 3, records). The products are those of
        the errors from motion x motion, motion x noise and noise x noise.
    n_samples
        Number of samples in each mean, n numbers.
    """

    measures: list[str]
    windows: list[str]
    products: Array
    n_samples: list[int]


def from_sums(sums: Sums, chosen: slice | Sequence[int] = slice(None)) -> Measured:
    """Compute the measures of replicates from a scheme's sums of squared errors.

    `chosen` are the indices of the replicates on the last axis of the sums; by default, all
    replicates are taken.
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
    """Compute largest error and 95th percentile of the error from squared errors (steps, records).

    The result has the shape (2, 3, records): the two measures, the three products of `Measured`,
    the records. Only the last product, noise x noise, is set; the other two products are zero.
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
    """Compute the measures of one record from the estimates of a scheme at each step.

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
        Number of the first step after the settling time.
    extremes
        Whether to compute `EXTREMES` too; this has no effect unless `motion` is None.
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
    conditions: Mapping[str, Value],
    replicates: Sequence[int],
    scheme: str,
    measured: Measured,
    amplitude: float | None,
) -> Columns:
    """Make the rows of one scheme and some records, as column name -> values.

    The rows of one record follow each other.

    Parameters
    ----------
    conditions
        Condition -> value, without the amplitude.
    replicates
        Numbers of the records in `measured`.
    scheme
        Name of the scheme.
    measured
        The measures of these records.
    amplitude
        Amplitude at which the records were run, m. Then the column `value` holds the product noise
        x noise, and the columns of products are NaN. If None, motion and noise were run separately;
        then the three products are stored, and `amplitude` and `value` are NaN.
    """
    measures, windows, means, samples = measured
    records, rows = len(replicates), len(measures) * len(replicates)
    products = means.transpose(1, 2, 0).reshape(3, rows)
    at, value = np.full((2, rows), np.nan)
    if amplitude is not None:
        at, value, products = np.full(rows, amplitude), products[2], np.full((3, rows), np.nan)
    return {
        **{name: _repeat(value, rows) for name, value in conditions.items()},
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


def _repeat(value: Value, rows: int) -> list[str] | Array:
    return [value] * rows if isinstance(value, str) else np.full(rows, value)


def failed(
    conditions: Mapping[str, Value],
    replicate: int,
    scheme: str,
    reason: str,
    amplitude: float | None,
) -> Columns:
    """Make the single row that says why one scheme failed in one record, as column -> values.

    `conditions` are as for `table`. `amplitude` is in m; it is None if the row stands for all
    amplitudes.
    """
    nothing = Measured([""], [""], np.full((1, 3, 1), np.nan), [0])
    row = table(conditions, [replicate], scheme, nothing, amplitude)
    return {**row, "status": ["failed"], "reason": [reason]}
