"""From errors to rows: MSE (Eq. 12), NEES and NIS, over the whole record and settled."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, get_type_hints

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.batch import Sums
from owtsweep.studies.hub.loop import Trajectory

QUANTITIES = ("x", "y", "vx", "vy", "nees", "nis")
WINDOWS = ("full", "settled")


class Row(NamedTuple):
    """One row of a shard."""

    natural_period: float
    replicate: int
    scheme: str
    measure: str
    window: str
    amplitude: float
    motion: float
    cross: float
    noise: float
    value: float
    n_samples: int
    status: str
    reason: str


#: Columns of a shard, in order, and what they hold.
COLUMNS: dict[str, type] = get_type_hints(Row)


class Measured(NamedTuple):
    """One measure of one record: means of the three products, and the number of samples."""

    measure: str
    window: str
    products: tuple[float, float, float]
    n_samples: int


def from_sums(sums: Sums, replicate: int) -> Iterator[Measured]:
    """The measures of the replicate with this index in the sums."""
    own = sums.products[..., replicate]
    for w, window in enumerate(WINDOWS):
        parts = slice(w, None)
        steps, innovations = int(sums.steps[parts].sum()), int(sums.innovations[parts].sum())
        counts = [innovations if name == "nis" else steps for name in QUANTITIES]
        means = own[parts].sum(axis=0) / np.maximum(counts, 1)[:, None]
        x, y, vx, vy = means[:4]
        found = [*means.tolist(), (x + y).tolist(), (vx + vy).tolist()]
        names = (*QUANTITIES, "position", "velocity")
        for name, mean, count in zip(names, found, [*counts, steps, steps], strict=True):
            if count:
                yield Measured(name, window, tuple(mean), count)
        if len(sums.squared):
            kept = sums.squared[0 if w == 0 else int(sums.steps[0]) :, replicate]
            yield from _extremes(kept, window)


def _extremes(squared: Array, window: str) -> Iterator[Measured]:
    error = np.sqrt(squared)
    largest, p95 = float(np.max(error)), float(np.percentile(error, 95.0))
    yield Measured("position_max", window, (0.0, 0.0, largest), len(error))
    yield Measured("position_p95", window, (0.0, 0.0, p95), len(error))


def from_trajectories(
    motion: Trajectory | None,
    noise: Trajectory,
    truth: Array,
    settled: int,
    *,
    extremes: bool = False,
) -> Iterator[Measured]:
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
            yield Measured(name, window, (float(mean[0]), float(mean[1]), float(mean[2])), count)
        if extremes and whole:
            yield from _extremes(np.sum(errors[0][start:, :2] ** 2, axis=1), window)


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


def row(
    natural_period: float,
    replicate: int,
    scheme: str,
    measured: Measured,
    amplitude: float | None,
) -> Row:
    """One row of a shard; with an amplitude the noise x noise product is the value itself."""
    measure, window, products, n_samples = measured
    name = (natural_period, replicate, scheme, measure, window)
    if amplitude is None:
        return Row(*name, np.nan, *products, np.nan, n_samples, "ok", "")
    return Row(*name, amplitude, np.nan, np.nan, np.nan, products[2], n_samples, "ok", "")


def failed_row(
    natural_period: float, replicate: int, scheme: str, reason: str, amplitude: float | None
) -> Row:
    """The one row of a failed case."""
    nothing = Measured("", "", (np.nan, np.nan, np.nan), 0)
    base = row(natural_period, replicate, scheme, nothing, amplitude)
    return base._replace(status="failed", reason=reason)
