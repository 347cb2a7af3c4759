"""What a record itself is: how long, how large, how fast, and the spectrum of Eq. (1) behind it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.contract import Scheme, Sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate
from owtsweep.studies.replay.measures import Measured
from owtsweep.studies.replay.measuring import measure
from owtsweep.studies.replay.record import Record


class Displacement(NamedTuple):
    """d: (n,) m along the main direction, around its mean; angle: that direction, rad from x;
    share: its part of the horizontal variance; source: what it was taken from."""

    values: Array
    angle: float
    share: float
    source: str


def displacement(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Displacement:
    """The motion along its main direction, from the truth or else from a scheme's estimate.

    Gaps of a reference are bridged by straight lines.
    """
    if record.position is not None:
        xy, source = record.position, record.truth
    else:
        found = estimate(config, scheme, sensors, measure(config, sensors, record, 0))
        xy, source = found.state[settled:, :2], f"the estimate of {scheme.name}"
    xy = bridged(xy)
    xy = xy - xy.mean(axis=0)
    variance, directions = np.linalg.eigh(xy.T @ xy / len(xy))
    main = directions[:, 1] * (
        1.0 if directions[np.argmax(np.abs(directions[:, 1])), 1] > 0 else -1
    )
    total = float(np.sum(variance))
    share = float(variance[1] / total) if total > 0.0 else 1.0
    return Displacement(xy @ main, float(np.arctan2(main[1], main[0])), share, source)


def bridged(xy: Array) -> Array:
    """(n, 2) with NaN rows replaced by straight lines; the ends by the nearest value."""
    there = np.isfinite(xy[:, 0])
    if np.all(there):
        return xy
    at = np.arange(len(xy))
    return np.stack([np.interp(at, at[there], xy[there, i]) for i in range(2)], axis=1)


def facts(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Iterator[Measured]:
    """Facts as measures: duration, rms and peak (m), and the fit of Eq. (1)."""
    from owtsweep.studies.replay.spectrum import fit

    found = displacement(config, record, sensors, scheme, settled)
    n = len(found.values)
    d = found.values
    rms = float(np.sqrt(np.mean(d**2) / found.share))  # of the horizontal displacement
    yield ("duration", "full", record.steps * sensors.step, record.steps)
    yield ("rms", "full", rms, n)
    yield ("peak", "full", float(np.max(np.abs(d))), n)
    yield ("direction", "full", float(np.rad2deg(found.angle)), n)
    yield ("direction_share", "full", found.share, n)
    if np.max(np.abs(d)) == 0.0:
        return
    fitted = fit(d, sensors.step, (config.band[0], config.band[1]))
    if fitted is None:
        return
    for name, value in fitted.items():
        yield (f"spectrum_{name}", "full", float(value), n)
