"""Say in sentences what a replay advises, which peaks a record has, and what a tilt costs there."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.motion.modes import LEAST_SHARE, LEVEL
from owtsweep.studies.hub.public import BASELINES, INSTEAD, believe, make_sensors
from owtsweep.studies.replay.advice import LEAST_MARGIN
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import MOST_MODES
from owtsweep.studies.replay.identification.words import ESTIMATED
from owtsweep.studies.replay.place import expect_at_record

#: A margin (an error / the best error - 1) of at least this is stated as a factor, not in percent.
MARGIN_IN_TIMES = 2.0
SOURCES = {
    "record": "this record's own errors",
    "fixes": "the distance from the fixes that came later",
    "map": "the expected map at its period and amplitude",
}


#: A row of the table of advice without what is missing; names that may be missing are "".
Row = Mapping[str, Any]


def write_sentence(row: Mapping[Hashable, object]) -> str:
    """Write one row of the table of advice as a sentence that begins with what is recommended."""
    known = {str(name): value for name, value in row.items() if value == value}  # without NaN
    given: Row = {"same_as": "", "runner_up": "", "baseline": "", **known}
    noise = " with the estimated noise" if given["noise"] == ESTIMATED else ""
    text = f"by {SOURCES[given['source']]}{noise}: {_recommend(given)}"
    if given["source"] != "map":
        return text
    covered = f"{100.0 * given['fit_share']:.0f} % of the variance"
    if given["advises"]:
        text += f"; the fit of Eq. (1) covers {covered}"
    else:
        text = f"no advice, only for the {covered} that the fit of Eq. (1) covers: {text}"
    if given["contradicts_record"]:
        text += "; this contradicts the record's own errors, which count because they judge all of "
        text += "its motion"
    return text


def _recommend(row: Row) -> str:
    chosen, runner_up = row["recommended"], row["runner_up"]
    if chosen in BASELINES and row["baseline"] == chosen:
        return _recommend_baseline(row)
    value, least = row["value_recommended"], row["value_best"]
    size = _describe_size(row["criterion"], value)
    same = row["same_as"].split()
    best = _name(row["best"], same)
    more = f"; {rival}" if (rival := _describe_rival(row)) else ""
    ends = _list_ends(row, "ci_low", "ci_high")
    if chosen != row["best"] and chosen not in same:
        ends = [-end for end in reversed(ends)] if chosen == runner_up else []
        less = f"{best} has {_describe_difference(least - value, value, *ends)}"
        return f"no difference that matters: run {chosen}, the simplest, {size}; {less}{more}"
    if not runner_up:
        return f"{best}, {size}; there is nothing to compare it with{more}"
    words = _describe_difference(row["margin"] * least, least, *ends)
    margin = f"{runner_up} has {words}"
    if not row["matters"]:
        return f"no difference that matters; {best}, {size}; {margin}{more}"
    return f"run {best}, {size}; {margin}{more}"


def _recommend_baseline(row: Row) -> str:
    chosen, best = row["baseline"], _name(row["best"], row["same_as"].split())
    value, difference = row["value_baseline"], row["baseline_difference"]
    ends = _list_ends(row, "baseline_ci_low", "baseline_ci_high")
    words = _describe_difference(difference, value, *ends)
    better = "no scheme is better"
    if difference < 0.0:
        better += " by a difference that matters"
    size = _describe_size(row["criterion"], value)
    if best == chosen:  # a baseline that stands among the schemes
        return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}"
    return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}; {best}, the best scheme, has {words}"


def _list_ends(row: Row, *names: str) -> list[float]:
    return [row[name] for name in names if name in row and row["source"] != "map"]


def _describe_rival(row: Row) -> str:
    baseline, least = row["baseline"], row["value_best"]
    if baseline in ("", row["best"]):
        return ""
    words = _describe_difference(row["value_baseline"] - least, least)
    return f"{baseline}, the best baseline, has {words}"


def _name(best: str, same: list[str]) -> str:
    return f"{best} (= {' = '.join(same)})" if same else best


def _describe_size(criterion: str, value: float) -> str:
    unit = "m/s" if criterion == "velocity" else "m"
    size = f"{value:.3g} {unit.replace('m', 'm²', 1).replace('/s', '/s²')}"
    if criterion == "fix_residual":
        return size + f" from a fix, its noise included (root {np.sqrt(value):.2g} {unit})"
    return size + f" {criterion} MSE (root {np.sqrt(value):.2g} {unit})"


def _describe_difference(difference: float, base: float, *ends: float) -> str:
    if not base > 0.0:
        return f"{difference:.3g} more"
    parts = [part / base for part in (difference, *ends)]
    if parts[0] >= MARGIN_IN_TIMES:
        told, unit, word = [f"{1.0 + part:.3g}" for part in parts], "times", "as much"
    elif parts[0] < 0.0:
        parts = [-parts[0], *(-part for part in reversed(parts[1:]))]
        told, unit, word = [f"{100.0 * part:.3g}" for part in parts], "%", "less"
    else:
        told, unit, word = [f"{100.0 * part:.3g}" for part in parts], "%", "more"
    interval = f" (95 %: {told[1]} to {told[2]} {unit})" if len(told) > 2 else ""
    return f"{told[0]} {unit} {word}{interval}"


def describe_modes(config: ReplayConfig, record: Mapping[str, float]) -> str:
    """Name the peaks of a record's spectrum: period, share of the variance, whether in the band."""
    low, high = config.fit_band
    peaks = []
    for number in range(1, MOST_MODES + 1):
        period = record[f"mode_{number}_period"]
        if np.isfinite(period):
            outside = "" if low <= 1.0 / period <= high else ", outside the band"
            share = 100.0 * record[f"mode_{number}_share"]
            peaks.append(f"{period:.3g} s ({share:.0f} % of the variance{outside})")
    text = f"peaks of the spectrum: {', '.join(peaks)}"
    if not peaks:
        text = f"the spectrum has no peak that is more than scatter (p < {LEVEL:g})"
    slow = record["slow_share"]
    if slow >= LEAST_SHARE:
        text += f"; {100.0 * slow:.0f} % of the variance has periods beyond "
        text += f"{record['slow_period']:.3g} s, too long for this record to time"
    return text


def describe_tilt(config: ReplayConfig, record: Mapping[str, float]) -> str:
    """Say what the tilt of the IMU costs at a record's period and size; "" without a tilt.

    Compared are the errors expected of filters that know the tilt, and of those that do not.
    """
    tilt = config.sensors.imu.tilt
    if isinstance(tilt, str) or tilt == 0.0:
        return ""
    text = f"a tilt of {tilt:g} rad/m"
    try:
        unaware, aware = (
            expect_at_record(believe(config, belief), record) for belief in (0.0, tilt)
        )
    except InputError as error:
        return f"{text}: what it costs cannot be computed: {error}"
    if not unaware or not aware:
        return f"{text}: the record has no place in the map, so what it costs is not known"
    lean = make_sensors(config.sensors).lean
    period = record["natural_period"]
    share = abs(lean) * (period / (2.0 * np.pi)) ** 2
    which = 1 if config.measures.criterion == "velocity" else 0
    unit = ("m", "m/s")[which]
    best_without = min(unaware, key=lambda name: unaware[name][which])
    best_known = min(aware, key=lambda name: aware[name][which])
    without, known = unaware[best_without][which], aware[best_known][which]
    verdict = "it does not matter at this period and size"
    if without > (1.0 + LEAST_MARGIN) * known:
        verdict = "it matters, so let the filters know it"
    elif known > (1.0 + LEAST_MARGIN) * without:
        verdict = "the motion is so small that filters do better if they take the IMU for level"
    return (
        f"{text} is {100.0 * share:.2g} % of the acceleration at {period:.3g} s; the least "
        f"expected error is {np.sqrt(without):.3g} {unit} ({best_without}) if the filters do not "
        f"know it, {np.sqrt(known):.3g} {unit} ({best_known}) if they do: {verdict}"
    )
