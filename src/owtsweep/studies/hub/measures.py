"""From errors to rows: MSE (Eq. 12), NEES and NIS, over the whole record and settled."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.batch import Sums
from owtsweep.studies.hub.loop import Trajectory

QUANTITIES = ("x", "y", "vx", "vy", "nees", "nis")
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


#: A measure's name, its window, (3, records) means of its products, and of how many samples.
_Entry = tuple[str, str, Array, int]


def from_sums(sums: Sums, chosen: slice | Sequence[int] = slice(None)) -> Measured:
    """The measures of the replicates with these indices in the sums."""
    return _gathered(_of_sums(sums, chosen))


def _of_sums(sums: Sums, chosen: slice | Sequence[int]) -> Iterator[_Entry]:
    products = sums.products[..., chosen]
    for w, window in enumerate(WINDOWS):
        parts = slice(w, None)
        steps, innovations = int(sums.steps[parts].sum()), int(sums.innovations[parts].sum())
        counts = [innovations if name == "nis" else steps for name in QUANTITIES]
        means = products[parts].sum(axis=0) / np.maximum(counts, 1)[:, None, None]
        x, y, vx, vy = means[:4]
        names, found = (*QUANTITIES, "position", "velocity"), (*means, x + y, vx + vy)
        for name, mean, count in zip(names, found, (*counts, steps, steps), strict=True):
            if count:
                yield name, window, mean, count
        if len(sums.squared):
            kept = sums.squared[0 if w == 0 else int(sums.steps[0]) :, chosen]
            yield from _extremes(kept, window)


def _gathered(entries: Iterable[_Entry]) -> Measured:
    measures, windows, means, samples = zip(*entries, strict=True)
    return Measured(list(measures), list(windows), np.stack(means), list(samples))


def _extremes(squared: Array, window: str) -> Iterator[_Entry]:
    """The largest error and its 95 % quantile, of (steps, records) squared errors."""
    error = np.sqrt(squared)
    for name, values in (
        ("position_max", np.max(error, axis=0)),
        ("position_p95", np.percentile(error, 95.0, axis=0)),
    ):
        nothing = np.zeros(len(values))
        yield name, window, np.stack([nothing, nothing, values]), len(error)


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
    return _gathered(_of_trajectories(motion, noise, truth, settled, extremes=extremes))


def _of_trajectories(
    motion: Trajectory | None,
    noise: Trajectory,
    truth: Array,
    settled: int,
    *,
    extremes: bool,
) -> Iterator[_Entry]:
    whole = motion is None
    errors = [noise.state - truth] if motion is None else [motion.state - truth, noise.state]
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
        for name, (mean, count) in means.items():
            yield name, window, mean[:, None], count
        if extremes and whole:
            yield from _extremes(np.sum(errors[0][start:, :2] ** 2, axis=1)[:, None], window)


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
