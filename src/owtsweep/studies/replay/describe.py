"""Say in sentences what a replay advises, what a record shows of its motion, sensors and tilt."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.motion.modes import LEAST_SHARE, LEVEL
from owtsweep.motion.recorded import tell_alone
from owtsweep.results.answer import tell_cell
from owtsweep.results.verdicts import SEPARATOR
from owtsweep.studies.hub.public import (
    BASELINES,
    INSTEAD,
    JUDGED,
    OTHER_WINDOW,
    assume_tilt,
    make_sensors,
)
from owtsweep.studies.replay.advice import LEAST_MARGIN, advise
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import MOST_MODES, summarise_motion
from owtsweep.studies.replay.measures import ESTIMATED, STATED, TAILS
from owtsweep.studies.replay.place import expect_at_record
from owtsweep.studies.replay.results import rank_schemes

if TYPE_CHECKING:
    import pandas as pd

#: A margin (an error / the best error - 1) of at least this is stated as a factor, not in percent.
MARGIN_IN_TIMES = 2.0
SOURCES = {
    "record": "this record's own errors",
    "fixes": "the distance from the fixes that came later",
    "map": "the expected map at its period and amplitude",
}
#: Noise that the answer rests on, of two -> what is said of it.
NOISES = {
    ESTIMATED: "Run with the noise that the record shows (noise.csv), not the stated one: errors "
    "are smaller.",
    STATED: "Run with the stated noise: errors are no smaller with what the record shows "
    "(noise.csv).",
}
#: NIS per degree of freedom outside of this range is said; a fix has two degrees of freedom.
RIGHT_NIS, FREEDOM = (0.5, 2.0), 2

#: A row of the table of advice without what is missing; names that may be missing are "".
Row = Mapping[str, Any]


def make_sentences(advised: pd.DataFrame) -> list[str]:
    """Write a sentence per row of the table of advice; it names the record if there are several."""
    many = advised["file"].nunique() > 1
    return [
        (f"{row['file']}: " if many else "") + write_sentence(row)
        for row in advised.to_dict("records")
    ]


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
    chosen, value, least = row["recommended"], row["value_recommended"], row["value_best"]
    same = row["same_as"].split()
    best = f"{row['best']} (= {' = '.join(same)})" if same else row["best"]
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    size = f"{value:.3g} {unit.replace('m', 'm²').replace('/s', '/s²')}"
    root = f"root {np.sqrt(value):.2g} {unit}"
    if row["criterion"] == "fix_residual":
        size += f" from a fix, its noise included ({root})"
    else:
        size += f" {row['criterion']} MSE ({root})"
    if chosen in BASELINES and row["baseline"] == chosen:
        worse = row["baseline_difference"]
        better = "no scheme is better" + " by a difference that matters" * bool(worse < 0.0)
        text = f"{INSTEAD[chosen]} ({chosen}), {size}: {better}"
        if best == chosen:  # a baseline that stands among the schemes
            return text
        ends = _list_ends(row, "baseline_ci_low", "baseline_ci_high")
        return f"{text}; {best}, the best scheme, has {_compare(worse, value, *ends)}"
    more = ""
    if (rival := row["baseline"]) not in ("", row["best"]):
        words = _compare(row["value_baseline"] - least, least)
        more = f"; {rival}, the best baseline, has {words}"
    ends = _list_ends(row, "ci_low", "ci_high")
    if chosen != row["best"] and chosen not in same:
        ends = [-end for end in reversed(ends)] if chosen == row["runner_up"] else []
        less = f"{best} has {_compare(least - value, value, *ends)}"
        return f"no difference that matters: run {chosen}, the simplest, {size}; {less}{more}"
    if not row["runner_up"]:
        return f"{best}, {size}; there is nothing to compare it with{more}"
    start = "run" if row["matters"] else "no difference that matters;"
    words = _compare(row["margin"] * least, least, *ends)
    return f"{start} {best}, {size}; {row['runner_up']} has {words}{more}"


def _list_ends(row: Row, *names: str) -> list[float]:
    return [row[name] for name in names if name in row and row["source"] != "map"]


def _compare(difference: float, base: float, *ends: float) -> str:
    if not base > 0.0:
        return f"{difference:.3g} more"
    parts = [part / base for part in (difference, *ends)]
    scale, start, unit, word = 100.0, 0.0, "%", "more"
    if parts[0] >= MARGIN_IN_TIMES:
        scale, start, unit, word = 1.0, 1.0, "times", "as much"
    elif parts[0] < 0.0:
        parts, word = [-parts[0], *(-part for part in reversed(parts[1:]))], "less"
    texts = [f"{start + scale * part:.3g}" for part in parts]
    interval = f" (95 %: {texts[1]} to {texts[2]} {unit})" if len(texts) > 2 else ""
    return f"{texts[0]} {unit} {word}{interval}"


def tell_answer(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return the answer in sentences, in a sweep's words; [] if no scheme has an error.

    Of several records it is by the mean of their squared errors, with the stated noise.
    """
    import pandas as pd

    row, counted = _pick_row(config, tables)
    if not row:
        return []
    chosen, same = row["recommended"], [row["best"], *row["same_as"].split()]
    second = ("runner_up", "value_runner_up") if chosen in same else ("best", "value_best")
    others = {*row["left"].split(SEPARATOR)} - {chosen, *same * (chosen in same)}
    cell = {
        "best": chosen,
        "verdict": "tie" if others else "won",
        "error_best": row["value_recommended"],
        "error_low": row.get("recommended_ci_low", np.nan),
        "error_high": row.get("recommended_ci_high", np.nan),
        "n": row["n"],
        "runner_up": row[second[0]],
        "error_runner_up": row.get(second[1], np.nan),
        "baseline": row["baseline"],
        "error_baseline": row.get("value_baseline", np.nan),
        "left": row["left"],
    }
    cell |= {name: np.sqrt(cell[name]) for name in cell if name.startswith("error_")}
    nothing = pd.DataFrame(columns=["scheme", "n"])
    criterion = JUDGED.get(row["criterion"], JUDGED["position"])
    sentences = tell_cell(pd.DataFrame([cell]), nothing, criterion, counted)
    if row["source"] == "fixes":
        sentences.append("Errors are distances from later fixes, and hold the noise of these.")
    noises = {*tables["advice"]["noise"]} if len(config.grid.files) == 1 else set()
    if ESTIMATED in noises:
        sentences.append(NOISES[row["noise"]])
    return sentences


def _pick_row(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> tuple[Row, str]:
    """Return the row of advice that the answer rests on, and what its samples are."""
    if len(config.grid.files) > 1:
        errors = tables["errors"].rename(columns={"mean": "value"})
        judged = config.measures
        row = advise(errors, rank_schemes(config), judged.criterion, judged.window, by="file")
        return row or {}, "record"
    own = tables["advice"][tables["advice"]["counts"].astype(bool)]
    if own.empty:
        return {}, ""
    known: Row = {str(name): value for name, value in own.iloc[0].dropna().items()}
    is_drawn = "recommended_ci_low" in known
    return {"same_as": "", "runner_up": "", "baseline": "", **known}, "draw" if is_drawn else "part"


def count_advice(advised: pd.DataFrame) -> str:
    """Say how often each scheme is recommended, by the errors on the records."""
    by_record = advised[(advised["source"] != "map") & (advised["noise"] != ESTIMATED)]
    counts = by_record["recommended"].value_counts()
    best = ", ".join(f"{name} in {count}" for name, count in counts.items())
    alike = int((~by_record["matters"].astype(bool)).sum())
    return (
        f"{len(by_record)} records; recommended: {best}; in {alike} no difference between schemes "
        "that matters (report.md)"
    )


def tell_scope(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return sentences on what the advice holds for: the motion, and the part of a record."""
    drawn = (tables["errors"]["n"] > 1).any()  # recorded sensors have the noise that they had
    motion = [f"The advice is for {tell_alone(*config.grid.files)}."] if drawn else []
    return [*motion, *_tell_windows(tables["advice"])]


def _tell_windows(advised: pd.DataFrame) -> list[str]:
    """Return sentences on the part of a record that the advice judges, and on the other part."""
    of_map = advised["source"] == "map"
    windows = list(dict.fromkeys(advised.loc[~of_map, "window"]))
    lines = [OTHER_WINDOW[window] for window in windows or dict.fromkeys(advised["window"])]
    if of_map.any() and "full" in windows:
        lines.append("The expected map judges the settled part.")
    return lines


def warn_of_noise(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Say where the stated noise does not fit the records: NIS first, then each parameter."""
    lines = []
    errors, advised, noise = tables["errors"], tables["advice"], tables["noise"]
    errors = errors[(errors["measure"] == "nis") & (errors["window"] == config.measures.window)]
    own = advised[(advised["source"] != "map") & (advised["noise"] != ESTIMATED)]
    for file in dict.fromkeys(advised["file"]):
        start = f"{file}: " if advised["file"].nunique() > 1 else ""
        for best in own[own["file"] == file]["best"]:
            for nis in errors[(errors["file"] == file) & (errors["scheme"] == best)]["mean"]:
                if not RIGHT_NIS[0] <= nis / FREEDOM <= RIGHT_NIS[1]:
                    size = "larger" if nis > FREEDOM else "smaller"
                    lines.append(
                        f"{start}the stated noise does not fit: {best}'s innovations are {size} "
                        f"than its noise explains (NIS {nis:.3g}, {FREEDOM} is right)"
                    )
        rows = noise[noise["file"] == file].to_dict("records")
        said = [*_compare_with_stated(rows)]
        if rows and not said:
            said = ["the stated noise agrees with the record, so no second run with estimates"]
        lines += [start + line for line in said]
    return lines


def _compare_with_stated(rows: list[dict[Hashable, Any]]) -> Iterator[str]:
    for row in rows:
        if row["parameter"] == TAILS:
            yield (
                f"the {TAILS.replace('_', ' ')} of the innovations is {row['estimate']:.2g} (0 for "
                "Gaussian noise): outliers or a changing quality of the positions, which no sigma "
                "describes"
            )
        elif not row["inside"]:
            also = ""
            if row["parameter"] == "sensors.gnss.delay":
                also = "; with the offset between the clocks of GNSS and IMU"
            yield (
                f"{row['parameter']}: {row['stated']:.4g} {row['unit']} stated, the record says "
                f"{format_estimate(row)}{also}"
            )


def format_estimate(row: Mapping[Hashable, Any]) -> str:
    """Write the estimate in a row of the table of noise, with its interval as far as it is one."""
    estimate, low, high, unit = (row[name] for name in ("estimate", "low", "high", "unit"))
    if row["parameter"] == TAILS:
        return f"{estimate:.2g}"
    open_below = np.isnan(low) or (low == 0.0 and unit != "s")
    if open_below and np.isnan(high):
        return "nothing about it"
    if open_below:
        return f"less than {high:.3g} {unit}"
    if np.isnan(high):
        return f"more than {low:.3g} {unit}"
    return f"{estimate:.3g} {unit} ({low:.3g} to {high:.3g})"


def count_doubted(noise: pd.DataFrame) -> list[str]:
    """Say on how many records the stated noise is not what the record shows; [] if on none."""
    doubted = noise[~noise["inside"].astype(bool)]["file"].nunique()
    return [f"on {doubted} records the stated noise is not the record's (noise.csv)"][:doubted]


def describe_motion(config: ReplayConfig, record: Mapping[str, float]) -> list[str]:
    """Describe a record's motion: its size, its peaks, the cost of a tilt, the fit of Eq. (1)."""
    facts = [
        f"displacement: rms {record['rms']:.3g} m, largest {record['peak']:.3g} m along "
        f"{record['direction']:.0f} deg from x, which carries "
        f"{100 * record['direction_share']:.0f} % of the variance",
        describe_modes(config, record),
        *filter(None, [describe_tilt(config, record)]),
    ]
    if not np.isfinite(record["natural_period"]):
        facts.append("Eq. (1) could not be fitted, so the record has no place in the expected map")
        return facts
    low, high = config.fit_band
    facts.append(
        f"Eq. (1): natural period {record['natural_period']:.4g} ± "
        f"{1.96 * record['natural_period_error']:.2g} s, half-bandwidth "
        f"{record['half_bandwidth']:.3g} ± {1.96 * record['half_bandwidth_error']:.2g} Hz, "
        + ", ".join(f"{name} = {record[name]:.4g}" for name in "abc")
        + f"; {100 * record['band_share']:.0f} % of the variance lies in the band "
        f"[{low:g}, {high:g}] Hz, and {100 * record['fit_share']:.0f} % under the curve, which is "
        "what the expected map judges"
    )
    facts += [f"the fit of Eq. (1): {warning}" for warning in list_fit_warnings(config)]
    if not low <= 1.0 / record["natural_period"] <= high:
        facts.append("its peak lies outside band, so it has no place in the expected map")
    return facts


def list_fit_warnings(config: ReplayConfig) -> tuple[str, ...]:
    """List warnings about the spectrum fitted to a run's first record, or why there is none."""
    fit = summarise_motion(config, config.grid.files[0]).fit
    return (fit,) if isinstance(fit, str) else fit.warnings


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
        both = [expect_at_record(assume_tilt(config, assumed), record) for assumed in (0.0, tilt)]
    except InputError as error:
        return f"{text}: what it costs cannot be computed: {error}"
    which = 1 if config.measures.criterion == "velocity" else 0
    least = [
        min((errors[which], name) for name, errors in expected.items())
        for expected in both
        if expected
    ]
    if len(least) < len(both):
        return f"{text}: the record has no place in the map, so what it costs is not known"
    (without, best_without), (known, best_known) = least
    verdict = "it does not matter at this period and size"
    if without > (1.0 + LEAST_MARGIN) * known:
        verdict = "it matters, so let the filters know it"
    elif known > (1.0 + LEAST_MARGIN) * without:
        verdict = "the motion is so small that filters do better if they take the IMU for level"
    period, unit = record["natural_period"], ("m", "m/s")[which]
    share = abs(make_sensors(config.sensors).lean) * (period / (2.0 * np.pi)) ** 2
    return (
        f"{text} is {100.0 * share:.2g} % of the acceleration at {period:.3g} s; the least "
        f"expected error is {np.sqrt(without):.3g} {unit} ({best_without}) if the filters do not "
        f"know it, {np.sqrt(known):.3g} {unit} ({best_known}) if they do: {verdict}"
    )
