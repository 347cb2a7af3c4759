"""Facts about a record itself: duration, size, direction, and the spectrum fitted to it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.whittle import Fit, fit_lines, periodogram
from owtsweep.studies.hub.public import Scheme, Sensors, make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.long_records import release_memory
from owtsweep.studies.replay.measures import Measured
from owtsweep.studies.replay.measuring import cut_into_pieces, listen
from owtsweep.studies.replay.record import Record

#: The spectrum is kept up to this many times the upper edge of the band.
BEYOND = 2.0


class Displacement(NamedTuple):
    """(n, 2) m around its mean, without gaps; and its source, in words."""

    values: Array
    source: str


def take_displacement(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Displacement:
    """The horizontal motion: the truth, or without one a scheme's settled estimate.

    The truth is that of `measures.window`, because simulations begin with a transient. Straight
    lines bridge gaps of a reference.
    """
    if record.position is not None:
        begin = settled if config.measures.window == "settled" else 0
        xy, source = bridge_gaps(record.position)[begin:], record.truth
    else:
        xy = _estimate_position(config, record, sensors, scheme)[settled:]
        source = f"the estimate of {scheme.name}"
    return Displacement(xy - xy.mean(axis=0), source)


def _estimate_position(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme
) -> Array:
    """(steps, 2) a scheme's estimate of the position, m."""
    signals = [listen(config, sensors, record, 0)]
    pieces = estimate_pieces(config, scheme, sensors, signals, cut_into_pieces(record.steps))
    position, begin = np.empty((record.steps, 2)), 0
    for (piece,) in pieces:
        end = begin + len(piece.state)
        position[begin:end] = piece.state[:, :2]
        begin = end
    return position


@dataclass(frozen=True)
class Description:
    """A record's spectrum.

    Attributes
    ----------
    source
        Where the displacement comes from, in words.
    moves
        Whether it is not zero.
    frequency, power
        Periodogram of the displacement, Hz and m^2/Hz, up to `BEYOND` times the band.
    fit
        Eq. (1) fitted inside the band, or the reason why it cannot be fitted.
    """

    source: str
    moves: bool
    frequency: Array
    power: Array
    fit: Fit | str


#: The descriptions of the last few records.
_DESCRIPTIONS: OrderedDict[Any, Description] = OrderedDict()
_MOST_KEPT = 4


def describe_spectrum(config: ReplayConfig, file: str) -> Description:
    """The spectrum of a file's record, the same as in its facts."""
    from owtsweep.studies.replay.loading import load_record

    kept = _DESCRIPTIONS.get(_make_key(config, file))
    if kept is not None:
        return kept
    sensors = make_sensors(config.sensors)
    scheme = resolve_all(config.schemes, config)[choose_describer(config)]
    settled = round(config.measures.settling_time / sensors.step)
    displacement = take_displacement(config, load_record(config, file), sensors, scheme, settled)
    return _fit(config, file, displacement, sensors.step)


def _make_key(config: ReplayConfig, file: str) -> tuple[str, ...]:
    from owtsweep.studies.replay.blocks import hash_file

    return file, hash_file(file), repr(config)


def _fit(config: ReplayConfig, file: str, displacement: Displacement, step: float) -> Description:
    """Fit a record's spectrum and keep the description."""
    xy = displacement.values
    frequency, power = periodogram(xy.T, step)
    shown = np.searchsorted(frequency, 1.1 * BEYOND * config.fit_band[1], "right")
    try:
        shape: Fit | str = fit_lines(frequency, power, band=config.fit_band)
    except InputError as error:
        shape = str(error)
    result = Description(
        displacement.source, bool(np.any(xy)), frequency[:shown].copy(), power[:shown].copy(), shape
    )
    _DESCRIPTIONS[_make_key(config, file)] = result
    while len(_DESCRIPTIONS) > _MOST_KEPT:
        _DESCRIPTIONS.popitem(last=False)
    return result


def choose_describer(config: ReplayConfig) -> int:
    """Index of the scheme that describes a motion without a reference: HME1, else the last."""
    names = [scheme.name for scheme in resolve_all(config.schemes, config)]
    return names.index("HME1") if "HME1" in names else len(names) - 1


def bridge_gaps(xy: Array) -> Array:
    """(n, 2) with straight lines in place of NaN rows, and the nearest value at both ends."""
    finite = np.isfinite(xy[:, 0])
    if np.all(finite):
        return xy
    at = np.arange(len(xy))
    return np.stack([np.interp(at, at[finite], xy[finite, i]) for i in range(2)], axis=1)


def find_main_direction(xy: Array) -> tuple[float, float]:
    """Direction of greatest variance, deg from x in (-90, 90], and its share of the variance."""
    variance, directions = np.linalg.eigh(xy.T @ xy / len(xy))
    x, y = directions[:, 1]
    angle = float(np.rad2deg(np.arctan2(y, x)))
    angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
    total = float(np.sum(variance))
    return angle, float(variance[1] / total) if total > 0.0 else 1.0


def measure_record(
    config: ReplayConfig, record: Record, sensors: Sensors, scheme: Scheme, settled: int
) -> Iterator[Measured]:
    """Facts as measures: duration (s), rms and peak (m), direction (deg), the fit of Eq. (1).

    The fit's `..._error` are standard errors; a report's ± is 1.96 times them.
    """
    displacement = take_displacement(config, record, sensors, scheme, settled)
    xy = displacement.values
    n = len(xy)
    angle, share = find_main_direction(xy)
    facts = {
        "duration": record.steps * sensors.step,
        "rms": float(np.sqrt(np.mean(xy[:, 0] ** 2 + xy[:, 1] ** 2))),
        "peak": float(np.max(np.hypot(xy[:, 0], xy[:, 1]))),
        "direction": angle,
        "direction_share": share,
    }
    shape = _fit(config, record.file, displacement, sensors.step).fit
    release_memory(record)
    if not isinstance(shape, str):
        facts |= {
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
    for name, value in facts.items():
        yield (name, "full", float(value), n)
