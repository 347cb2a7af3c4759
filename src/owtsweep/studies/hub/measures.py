"""From errors to rows: MSE (Eq. 12), NEES and NIS, over the whole record and settled."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.batch import Sums

QUANTITIES = ("x", "y", "vx", "vy", "nees", "nis")
#: Of the position's error, where each record is run at its amplitude.
EXTREMES = ("position_max", "position_p95")
WINDOWS = ("full", "settled")

#: Some columns by name: numbers or words.
Table = dict[str, Array | NDArray[np.int64] | list[str]]
#: Columns of a shard, in order.
COLUMNS = (
    "natural_period",
    "replicate",
    "scheme",
    "measure",
    "window",
    "amplitude",
    "motion",
    "cross",
    "noise",
    "value",
    "n_samples",
    "status",
    "reason",
)


class Measured(NamedTuple):
    """Some measures of some records.

    measures and windows (n): their names; products (n, 3, records): means of the three products;
    n_samples (n): of how many samples.
    """

    measures: list[str]
    windows: list[str]
    products: Array
    n_samples: list[int]


def from_sums(sums: Sums, chosen: slice | Sequence[int] = slice(None)) -> Measured:
    """The measures of the replicates with these indices in the sums."""
    names = [*QUANTITIES, "position", "velocity", *(EXTREMES if len(sums.squared) else ())]
    # of the whole record and settled, as all that follows
    steps, innovations = (np.array([sum(n), n[1]]) for n in (sums.steps, sums.innovations))
    counts = np.stack([innovations if name == "nis" else steps for name in names], axis=1)
    products = sums.products[..., chosen]
    own = np.stack([products.sum(axis=0), products[1]])
    means = own / np.maximum(counts[:, : own.shape[1]], 1)[..., None, None]
    x, y, vx, vy = means.swapaxes(0, 1)[:4]
    parts = [means, np.stack([x + y, vx + vy], axis=1)]
    if len(sums.squared):
        kept = (sums.squared[first:, chosen] for first in (0, int(sums.steps[0])))
        parts.append(np.stack([_extremes(squared) for squared in kept]))
    have = counts > 0  # no fix after the settling time: no innovation
    entries = [(name, window) for window in WINDOWS for name in names]
    measures, windows = zip(*(entries[i] for i in np.flatnonzero(have)), strict=True)
    found = np.concatenate(parts, axis=1)[have]
    return Measured(list(measures), list(windows), found, counts[have].tolist())


def _extremes(squared: Array) -> Array:
    """`EXTREMES` of (steps, records) squared errors, as product 2."""
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
    """The measures of a record that was run step by step.

    Parameters
    ----------
    motion
        The response to the unit motion alone, or None when `noise` is the whole series.
    noise
        The response to everything else, or to the whole series.
    truth
        (steps, 4): the true state of the motion, or of the whole series.
    settled
        The first settled step.
    """
    whole = motion is None
    errors = [noise.state - truth] if motion is None else [motion.state - truth, noise.state]
    entries = []
    for window, start in zip(WINDOWS, (0, settled), strict=True):
        steps = len(truth) - start
        means: dict[str, tuple[Array, int]] = {}
        for i, name in enumerate(QUANTITIES[:4]):
            means[name] = (_products([e[start:, i] for e in errors], None), steps)
        means["position"] = (means["x"][0] + means["y"][0], steps)
        means["velocity"] = (means["vx"][0] + means["vy"][0], steps)
        if noise.covariance is not None:
            have = np.isfinite(noise.covariance[start:, 0, 0])
            weights = np.linalg.inv(noise.covariance[start:][have])
            means["nees"] = (_products([e[start:][have] for e in errors], weights), int(have.sum()))
        if noise.innovation is not None and noise.innovation_covariance is not None:
            have = np.isfinite(noise.innovation[start:, 0])
            weights = np.linalg.inv(noise.innovation_covariance[start:][have])
            parts = [t.innovation for t in (motion, noise) if t is not None]
            chosen = [part[start:][have] for part in parts if part is not None]
            if have.any():
                means["nis"] = (_products(chosen, weights), int(have.sum()))
        if extremes and whole:
            squared = np.sum(errors[0][start:, :2] ** 2, axis=1)[:, None]
            found = zip(EXTREMES, _extremes(squared)[..., 0], strict=True)
            means |= {name: (mean, steps) for name, mean in found}
        for name, (mean, count) in means.items():
            entries.append((name, window, mean[:, None], count))
    names, windows, products, counts = zip(*entries, strict=True)
    return Measured(list(names), list(windows), np.stack(products), list(counts))


def _products(errors: list[Array], weights: Array | None) -> Array:
    """Means of motion x motion, motion x noise, noise x noise; (3,)."""

    def mean(a: Array, b: Array) -> float:
        if weights is None:
            return float(np.mean(a * b))
        return float(np.mean(np.einsum("ki,kij,kj->k", a, weights, b)))

    if len(errors) == 1:
        return np.array([0.0, 0.0, mean(errors[0], errors[0])])
    motion, noise = errors
    return np.array([mean(motion, motion), mean(motion, noise), mean(noise, noise)])


def table(
    natural_period: float,
    replicates: Sequence[int],
    scheme: str,
    measured: Measured,
    amplitude: float | None,
) -> Table:
    """Rows of a shard, record by record; with an amplitude the noise x noise product is the value.

    Parameters
    ----------
    natural_period, amplitude
        In s and in m; no amplitude for superposed records, of which all have these products.
    replicates
        Their numbers, as many as `measured` has records.
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
) -> Table:
    """The one row of a failed case."""
    nothing = Measured([""], [""], np.full((1, 3, 1), np.nan), [0])
    row = table(natural_period, [replicate], scheme, nothing, amplitude)
    return {**row, "status": ["failed"], "reason": [reason]}
