"""What a record itself is: how long, how large, how fast, and the spectrum of Eq. (1) behind it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.whittle import Fit, fit_lines, periodogram
from owtsweep.studies.hub.contract import Scheme, Sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimates
from owtsweep.studies.replay.measures import Measured
from owtsweep.studies.replay.measuring import listen, pieces_of
from owtsweep.studies.replay.memory import give_back
from owtsweep.studies.replay.record import Record

#: Upper end of the spectrum that is kept over the upper edge of the band.
BEYOND = 2.0


class Displacement(NamedTuple):
    """(n, 2) m around its mean, without gaps, and what it was taken from."""

    values: Array
    source: str


def displacement(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Displacement:
    """The horizontal motion, from the truth or else from a scheme's settled estimate.

    It is that of the window which is judged: simulations begin with a transient of their own.
    Gaps of a reference are bridged by straight lines.
    """
    if record.position is not None:
        begin = settled if config.measures.window == "settled" else 0
        xy, source = bridged(record.position)[begin:], record.truth
    else:
        xy = _estimated(config, record, sensors, scheme)[settled:]
        source = f"the estimate of {scheme.name}"
    return Displacement(xy - xy.mean(axis=0), source)


def _estimated(config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme) -> Array:
    """(steps, 2) a scheme's estimate of the position."""
    signals = [listen(config, sensors, record, 0)]
    pieces = estimates(config, scheme, sensors, signals, pieces_of(record.steps))
    position, begin = np.empty((record.steps, 2)), 0
    for (piece,) in pieces:
        end = begin + len(piece.state)
        position[begin:end] = piece.state[:, :2]
        begin = end
    return position


@dataclass(frozen=True)
class Description:
    """What is kept of a record's spectrum.

    Attributes
    ----------
    source
        What the displacement was taken from.
    moves
        Whether there is any.
    frequency, power
        Periodogram of the displacement, Hz and m^2/Hz, up to `BEYOND` times the band.
    fit
        Eq. (1) fitted inside the band, or why it cannot be.
    """

    source: str
    moves: bool
    frequency: Array
    power: Array
    fit: Fit | str


_KEPT = 4
_KNOWN: OrderedDict[Any, Description] = OrderedDict()


def described(config: ReplayConfig, file: str) -> Description:
    """The spectrum of a file's record, as its facts have it; that of the last few is kept."""
    from owtsweep.studies.hub.schemes import resolve_all
    from owtsweep.studies.hub.sensors import sensors
    from owtsweep.studies.replay.loading import load_record

    kept = _KNOWN.get(_key(config, file))
    if kept is not None:
        return kept
    known = sensors(config.sensors)
    scheme = resolve_all(config.schemes, config)[describer(config)]
    settled = round(config.measures.settling_time / known.step)
    found = displacement(config, load_record(config, file), known, scheme, settled)
    return _describe(config, file, found, known.step)


def _key(config: ReplayConfig, file: str) -> tuple[str, ...]:
    from owtsweep.studies.replay.blocks import digest

    return file, digest(file), repr(config)


def _describe(config: ReplayConfig, file: str, found: Displacement, step: float) -> Description:
    """Fit a record's spectrum and keep what comes of it."""
    frequency, power = periodogram(found.values.T, step)
    shown = np.searchsorted(frequency, 1.1 * BEYOND * config.fit_band[1], "right")
    try:
        shape: Fit | str = fit_lines(frequency, power, band=config.fit_band)
    except InputError as error:
        shape = str(error)
    result = Description(
        found.source, bool(np.any(found.values)), frequency[:shown].copy(), power[:shown].copy(),
        shape,
    )  # fmt: skip
    _KNOWN[_key(config, file)] = result
    while len(_KNOWN) > _KEPT:
        _KNOWN.popitem(last=False)
    return result


def describer(config: ReplayConfig) -> int:
    """Which scheme's estimates describe the motion of a record without a reference."""
    from owtsweep.studies.hub.schemes import resolve_all

    names = [scheme.name for scheme in resolve_all(config.schemes, config)]
    return names.index("HME1") if "HME1" in names else len(names) - 1


def bridged(xy: Array) -> Array:
    """(n, 2) with NaN rows replaced by straight lines; the ends by the nearest value."""
    there = np.isfinite(xy[:, 0])
    if np.all(there):
        return xy
    at = np.arange(len(xy))
    return np.stack([np.interp(at, at[there], xy[there, i]) for i in range(2)], axis=1)


def main_direction(xy: Array) -> tuple[float, float]:
    """Direction of most variance, deg from x in (-90, 90], and its part of the variance."""
    variance, directions = np.linalg.eigh(xy.T @ xy / len(xy))
    x, y = directions[:, 1]
    angle = float(np.rad2deg(np.arctan2(y, x)))
    angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
    total = float(np.sum(variance))
    return angle, float(variance[1] / total) if total > 0.0 else 1.0


def facts(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Iterator[Measured]:
    """Facts as measures: duration (s), rms and peak (m), direction (deg), the fit of Eq. (1).

    Its `..._error` are standard errors; a report's ± is 1.96 of them.
    """
    found_xy = displacement(config, record, sensors, scheme, settled)
    xy = found_xy.values
    n = len(xy)
    angle, share = main_direction(xy)
    found = {
        "duration": record.steps * sensors.step,
        "rms": float(np.sqrt(np.mean(xy[:, 0] ** 2 + xy[:, 1] ** 2))),
        "peak": float(np.max(np.hypot(xy[:, 0], xy[:, 1]))),
        "direction": angle,
        "direction_share": share,
    }
    shape = _describe(config, record.file, found_xy, sensors.step).fit
    give_back(record)
    if not isinstance(shape, str):
        found |= {
            "natural_period": shape.natural_period,
            "natural_period_error": shape.errors["natural_period"],
            "half_bandwidth": shape.half_bandwidth,
            "half_bandwidth_error": shape.errors["half_bandwidth"],
            "a": shape.spectrum.a,
            "b": shape.spectrum.b,
            "c": shape.spectrum.c,
            "band_share": shape.band_share,
            "fit_p": shape.probability,
        }
    for name, value in found.items():
        yield (name, "full", float(value), n)
