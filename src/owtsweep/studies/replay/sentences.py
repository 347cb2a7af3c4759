"""Say in sentences what a replay advises, which peaks a record has, and what a tilt costs there."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import NamedTuple

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


class Advice(NamedTuple):
    """A row of the table of advice: its texts, "" where there is none, and the numbers it has."""

    texts: Mapping[str, str]
    numbers: Mapping[str, float]


def read_advice(row: Mapping[Hashable, object]) -> Advice:
    """Tell the texts of a row of the table of advice from its numbers; NaN stands for neither."""
    known = {str(name): value for name, value in row.items() if value == value}
    texts = {name: value for name, value in known.items() if isinstance(value, str)}
    numbers = {name: value for name, value in known.items() if isinstance(value, int | float)}
    return Advice({"same_as": "", "runner_up": "", "baseline": "", **texts}, numbers)


def write_sentence(row: Mapping[Hashable, object]) -> str:
    """Write one row of the table of advice as a sentence that begins with what is recommended."""
    advice = read_advice(row)
    texts, numbers = advice
    noise = " with the estimated noise" if texts["noise"] == ESTIMATED else ""
    text = f"by {SOURCES[texts['source']]}{noise}: {_recommend(advice)}"
    if texts["source"] != "map":
        return text
    covered = f"{100.0 * numbers['fit_share']:.0f} % of the variance"
    if numbers["advises"]:
        text += f"; the fit of Eq. (1) covers {covered}"
    else:
        text = f"no advice, only for the {covered} that the fit of Eq. (1) covers: {text}"
    if numbers["contradicts_record"]:
        text += "; this contradicts the record's own errors, which count because they judge all of "
        text += "its motion"
    return text


def _recommend(advice: Advice) -> str:
    texts, numbers = advice
    chosen, runner_up = texts["recommended"], texts["runner_up"]
    if chosen in BASELINES and texts["baseline"] == chosen:
        return _recommend_baseline(advice)
    value, least = numbers["value_recommended"], numbers["value_best"]
    size = _describe_size(texts["criterion"], value)
    same = texts["same_as"].split()
    best = _name(texts["best"], same)
    more = f"; {rival}" if (rival := _describe_rival(advice)) else ""
    ends = _list_ends(advice, "ci_low", "ci_high")
    if chosen != texts["best"] and chosen not in same:
        ends = [-end for end in reversed(ends)] if chosen == runner_up else []
        less = f"{best} has {_describe_difference(least - value, value, *ends)}"
        return f"no difference that matters: run {chosen}, the simplest, {size}; {less}{more}"
    if not runner_up:
        return f"{best}, {size}; there is nothing to compare it with{more}"
    words = _describe_difference(numbers["margin"] * least, least, *ends)
    margin = f"{runner_up} has {words}"
    if not numbers["matters"]:
        return f"no difference that matters; {best}, {size}; {margin}{more}"
    return f"run {best}, {size}; {margin}{more}"


def _recommend_baseline(advice: Advice) -> str:
    texts, numbers = advice
    chosen, best = texts["baseline"], _name(texts["best"], texts["same_as"].split())
    value, difference = numbers["value_baseline"], numbers["baseline_difference"]
    ends = _list_ends(advice, "baseline_ci_low", "baseline_ci_high")
    words = _describe_difference(difference, value, *ends)
    better = "no scheme is better"
    if difference < 0.0:
        better += " by a difference that matters"
    size = _describe_size(texts["criterion"], value)
    if best == chosen:  # a baseline that stands among the schemes
        return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}"
    return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}; {best}, the best scheme, has {words}"


def _list_ends(advice: Advice, *names: str) -> list[float]:
    numbers = {} if advice.texts["source"] == "map" else advice.numbers
    return [numbers[name] for name in names if name in numbers]


def _describe_rival(advice: Advice) -> str:
    baseline, least = advice.texts["baseline"], advice.numbers["value_best"]
    if baseline in ("", advice.texts["best"]):
        return ""
    words = _describe_difference(advice.numbers["value_baseline"] - least, least)
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
