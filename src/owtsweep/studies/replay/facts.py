"""Measure a record itself: duration, size and direction of the motion, and a fitted spectrum."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.modes import Modes, find_modes
from owtsweep.motion.whittle import Fit, fit_lines, periodogram
from owtsweep.studies.hub.public import BASELINES, Scheme, make_sensors, resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.loading import Source, load_record, name_source
from owtsweep.studies.replay.measures import Measured
from owtsweep.studies.replay.record import ReplayRecord, cut_into_pieces, listen

if TYPE_CHECKING:
    import pandas as pd

#: The scheme whose estimates describe a record without reference position, if it is run.
DESCRIBER = "HME1"
#: The periodogram is kept up to this multiple of the upper edge of the band.
BEYOND = 2.0


#: The measures of a record, which are columns of records.csv beside those of `replay.table`.
FACTS = (
    "duration", "rms", "peak", "direction", "direction_share", "natural_period",
    "natural_period_error", "half_bandwidth", "half_bandwidth_error", "a", "b", "c", "band_share",
    "fit_p", "fit_share", "slow_share", "slow_period",
    *(f"mode_{number}_{what}" for number in (1, 2, 3) for what in ("period", "share", "p")),
)  # fmt: skip
#: At most this many peaks of the spectrum are facts about a record.
MOST_MODES = 3


def pick_facts(records: pd.DataFrame) -> dict[str, float]:
    """Return the facts in the first row of a table of records; NaN for a fact that is not there."""
    line = records.iloc[0]
    return {name: float(line.get(name, np.nan)) for name in FACTS}


@dataclass(frozen=True)
class MotionSummary:
    """The horizontal motion of a record, in numbers.

    source: where the displacement comes from, in words.
    samples: Number of samples of the displacement.
    size: "rms" and "peak" (m), "direction" of greatest variance (degrees from x), and
        "direction_share", the variance's share (0 to 1) along it.
    frequency, power: the periodogram: Hz and m^2/Hz, (n,), up to a little above `BEYOND` bands.
    modes: the peaks of the spectrum at all frequencies.
    fit: the spectrum of Eq. (1) fitted inside the band, or the reason why it cannot be fitted.
    """

    source: str
    samples: int
    size: Mapping[str, float]
    frequency: Array
    power: Array
    modes: Modes
    fit: Fit | str


def summarise_motion(config: ReplayConfig, file: str) -> MotionSummary:
    """Summarise the motion of the record in a file; the last few summaries stay in memory."""
    return _summarise(name_source(config, file, config))


@lru_cache(maxsize=4)
def _summarise(key: Source) -> MotionSummary:
    config = key.config
    record = load_record(config, key.file)
    xy, source = _take_displacement(config, record)
    angle, share = _find_main_direction(xy)
    size = {
        "rms": float(np.sqrt(np.mean(xy[:, 0] ** 2 + xy[:, 1] ** 2))),
        "peak": float(np.max(np.hypot(xy[:, 0], xy[:, 1]))),
        "direction": angle,
        "direction_share": share,
    }
    frequency, power = periodogram(xy.T, record.step)
    shown = np.searchsorted(frequency, 1.1 * BEYOND * config.fit_band[1], "right")
    try:
        fitted: Fit | str = fit_lines(frequency, power, band=config.fit_band)
    except InputError as error:
        fitted = str(error)
    modes = find_modes(xy, record.step)
    record.release_memory()
    return MotionSummary(
        source, len(xy), size, frequency[:shown].copy(), power[:shown].copy(), modes, fitted
    )


def _take_displacement(config: ReplayConfig, record: ReplayRecord) -> tuple[Array, str]:
    settled = config.measures.find_settled(record.step)
    if record.position is not None:
        begin = settled if config.measures.window == "settled" else 0
        xy, source = _bridge_gaps(record.position)[begin:], record.truth
    else:
        scheme = resolve_all(config.schemes, config)[choose_describer(config)]
        xy = _estimate_position(config, record, scheme)[settled:]
        source = f"the estimate of {scheme.name}"
    return xy - xy.mean(axis=0), source


def _estimate_position(config: ReplayConfig, record: ReplayRecord, scheme: Scheme) -> Array:
    sensors = make_sensors(config.sensors)
    signals = [listen(config, sensors, record, 0)]
    pieces = estimate_pieces(config, scheme, sensors, signals, cut_into_pieces(record.steps))
    return np.concatenate([piece.state[:, :2].copy() for (piece,) in pieces])


def choose_describer(config: ReplayConfig) -> int:
    """Return the index of the scheme whose estimates describe a record without reference position.

    This is `DESCRIBER`, or else the last scheme that is no baseline, if there is one.
    """
    names = [scheme.name for scheme in resolve_all(config.schemes, config)]
    estimators = [name for name in names if name not in BASELINES] or names
    return names.index(DESCRIBER if DESCRIBER in names else estimators[-1])


def _bridge_gaps(xy: Array) -> Array:
    # by straight lines, at the ends by constants
    finite = np.isfinite(xy[:, 0])
    if np.all(finite):
        return xy
    at = np.arange(len(xy))
    return np.stack([np.interp(at, at[finite], xy[finite, i]) for i in range(2)], axis=1)


def _find_main_direction(xy: Array) -> tuple[float, float]:
    """Return the angle from x in degrees, in (-90, 90], and the variance's share along it."""
    variance, directions = np.linalg.eigh(xy.T @ xy / len(xy))
    x, y = directions[:, 1]
    angle = float(np.rad2deg(np.arctan2(y, x)))
    angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
    total = float(np.sum(variance))
    return angle, float(variance[1] / total) if total > 0.0 else 1.0


def measure_record(config: ReplayConfig, record: ReplayRecord) -> Iterator[Measured]:
    """Yield the facts about a record, each as (name, window "full", value, number of samples).

    They are `FACTS`: s, m, degrees; `..._error` are standard errors of the fit of Eq. (1),
    `mode_...` the peaks of the spectrum, largest first, and `slow_share` the variance's share of
    periods beyond `slow_period` (s), which a record of this duration cannot time.
    """
    summary = summarise_motion(config, record.file)
    facts = {"duration": record.steps * record.step, **summary.size}
    fitted = summary.fit
    if not isinstance(fitted, str):
        for name in ("natural_period", "half_bandwidth"):
            facts |= {name: getattr(fitted, name), f"{name}_error": fitted.errors[name]}
        facts |= {name: getattr(fitted.spectrum, name) for name in "abc"}
        facts |= {"band_share": fitted.band_share, "fit_p": fitted.probability}
        facts["fit_share"] = fitted.band_share * fitted.explained
    facts["slow_share"] = summary.modes.slow_share
    facts["slow_period"] = 1.0 / summary.modes.resolution
    for number, mode in enumerate(summary.modes.found[:MOST_MODES], start=1):
        facts |= {f"mode_{number}_{name}": getattr(mode, name) for name in ("period", "share", "p")}
    for name, value in facts.items():
        yield (name, "full", float(value), summary.samples)
