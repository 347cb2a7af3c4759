"""Say in sentences what a replay advises, what a record shows of its motion, sensors and tilt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from owtsweep.errors import InputError
from owtsweep.motion.modes import LEAST_SHARE, LEVEL
from owtsweep.motion.recorded import tell_alone
from owtsweep.results.answer import count_names, tell_cell
from owtsweep.results.verdicts import SEPARATOR
from owtsweep.studies.hub.public import INSTEAD, JUDGED, assume_tilt, make_sensors, tell_window
from owtsweep.studies.replay.advice import LEAST_MARGIN, advise
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import MOST_MODES, summarise_motion
from owtsweep.studies.replay.identification.of_record import round_delay
from owtsweep.studies.replay.measures import ESTIMATED, STATED, TAILS
from owtsweep.studies.replay.place import expect_at_record, find_measure
from owtsweep.studies.replay.results import rank_schemes

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


def tell_answer(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return the answer in sentences, in a sweep's words; [] if no scheme has an error.

    Of several records it is by the mean of their squared errors, with the stated noise.
    """
    if len(config.grid.files) > 1:
        errors = tables["errors"].rename(columns={"mean": "value"})
        judged = config.measures
        row = advise(errors, rank_schemes(config), judged.criterion, judged.window, by="file")
        return _tell(row, "record") if row else []
    advised = tables["advice"]
    own = advised[advised["counts"].astype(bool)].to_dict("records")
    if not own:
        return []
    both = ESTIMATED in {*advised["noise"]}
    noise = [NOISES[own[0]["noise"]]] * both
    return [*_tell(own[0]), *_tell_without_noise(config, tables["noise"], own[0]), *noise]


def _tell_without_noise(
    config: ReplayConfig, noise: pd.DataFrame, row: Mapping[Any, Any]
) -> list[str]:
    """Return a sentence on an error that is measured by fixes, less these fixes' own noise."""
    if row["source"] != "fixes":
        return []
    shown = noise.loc[noise["parameter"] == "sensors.gnss.sigma", "estimate"]
    sigma = float(shown.iloc[0]) if len(shown) else make_sensors(config.sensors).position_sigma
    left = float(row["value_recommended"]) - 2.0 * sigma**2  # of both axes
    if left <= 0.0:
        return []
    criterion = JUDGED["position"]
    error = criterion.show(float(criterion.express(left)))
    return [f"Without that noise, {criterion.show(sigma)} per axis, it is some {error}."]


def tell_others(advised: pd.DataFrame) -> list[str]:
    """Return a sentence or more per row of the table of advice that is not the answer itself.

    Of several records these are all; each begins with the record's name.
    """
    many = advised["file"].nunique() > 1
    return [
        (f"{row['file']}: " if many else "") + tell_row(row)
        for row in advised.to_dict("records")
        if many or not row["counts"]
    ]


def tell_row(row: Mapping[Any, Any]) -> str:
    """Return in a few sentences what a row of the table of advice says, and by what."""
    noise = " with the estimated noise" if row["noise"] == ESTIMATED else ""
    text = f"by {SOURCES[row['source']]}{noise}: {' '.join(_tell(row))}"
    if row["source"] != "map":
        return text
    covered = f"{100.0 * row['fit_share']:.0f} % of the variance"
    if row["advises"]:
        text += f" The fit of Eq. (1) covers {covered}."
    else:
        text = (
            "The expected map is no advice here: the fit of Eq. (1) covers only "
            f"{covered}. It says, {text}"
        )
    if row["contradicts_record"]:
        text += " This contradicts the record's own errors, which count because they judge all of "
        text += "its motion."
    return text


def _tell(row: Mapping[Any, Any], counted: str = "") -> list[str]:
    given = {str(name): value for name, value in row.items() if value == value}  # without NaN
    chosen, same = given["recommended"], [given["best"], *given.get("same_as", "").split()]
    second = ("runner_up", "value_runner_up") if chosen in same else ("best", "value_best")
    others = {*given["left"].split(SEPARATOR)} - {chosen, *same * (chosen in same)}
    cell = {
        "best": chosen,
        "verdict": "tie" if others else "won",
        "error_best": given["value_recommended"],
        "error_low": given.get("recommended_ci_low", np.nan),
        "error_high": given.get("recommended_ci_high", np.nan),
        "n": 0 if given["source"] == "map" else given["n"],
        "runner_up": given.get(second[0], ""),
        "error_runner_up": given.get(second[1], np.nan),
        "baseline": given.get("baseline", ""),
        "error_baseline": given.get("value_baseline", np.nan),
        "left": given["left"],
    }
    cell |= {name: np.sqrt(cell[name]) for name in cell if name.startswith("error_")}
    counted = counted or ("draw" if "recommended_ci_low" in given else "part")
    nothing = pd.DataFrame(columns=["scheme", "n"])
    criterion = JUDGED.get(given["criterion"], JUDGED["position"])
    sentences = tell_cell(pd.DataFrame([cell]), nothing, criterion, counted)
    if chosen in INSTEAD:
        sentences.append(f"{chosen}: {INSTEAD[chosen]}.")
    if given["source"] == "fixes":
        sentences.append("Errors are distances from later fixes, and hold the noise of these.")
    return sentences


def count_advice(advised: pd.DataFrame) -> str:
    """Say how often each scheme is recommended, by the errors on the records."""
    by_record = advised[(advised["source"] != "map") & (advised["noise"] != ESTIMATED)]
    alike = int((~by_record["matters"].astype(bool)).sum())
    return (
        f"{len(by_record)} records; recommended: {count_names(by_record['recommended'])}; in "
        f"{alike} no difference between schemes that matters (report.md)"
    )


def tell_scope(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return sentences on what the advice holds for: the motion, and the part of a record."""
    advised, lines = tables["advice"], []
    if (tables["errors"]["n"] > 1).any():  # recorded sensors have the noise that they had
        lines.append(f"The advice is for {tell_alone(*config.grid.files)}.")
    of_map = advised["source"] == "map"
    windows = list(dict.fromkeys(advised.loc[~of_map, "window"]))
    judged = windows or dict.fromkeys(advised["window"])
    lines += [tell_window(window, config.measures.settling_time) for window in judged]
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
        said = [*_compare_with_stated(config, rows)]
        if rows and not said:
            said = ["the stated noise agrees with the record, so no second run with estimates"]
        lines += [start + line for line in said]
    return lines


def _compare_with_stated(config: ReplayConfig, rows: list[dict[Any, Any]]) -> Iterator[str]:
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
                whole = round_delay(row["estimate"], config.sensors.imu.rate)
                also = (
                    "; with the offset between the clocks of GNSS and IMU; in whole IMU steps: "
                    f"sensors.gnss.delay={whole:.10g}"
                )
            yield (
                f"{row['parameter']}: {row['stated']:.4g} {row['unit']} stated, the record says "
                f"{format_estimate(row)}{also}"
            )


def format_estimate(row: Mapping[Any, Any]) -> str:
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
        f"Eq. (1): {tell_fit(record)}, "
        + ", ".join(f"{name} = {record[name]:.4g}" for name in "abc")
        + f"; {100 * record['band_share']:.0f} % of the variance lies in the band "
        f"[{low:g}, {high:g}] Hz, and {100 * record['fit_share']:.0f} % under the curve, which is "
        "what the expected map judges"
    )
    facts += [f"the fit of Eq. (1): {warning}" for warning in list_fit_warnings(config)]
    if not low <= 1.0 / record["natural_period"] <= high:
        facts.append("its peak lies outside band, so it has no place in the expected map")
    return facts


def tell_fit(record: Mapping[str, float]) -> str:
    """Tell period and half-bandwidth of the spectrum fitted to a record, with their intervals."""
    period, bandwidth = (
        f"{record[name]:.{digits}g} ± {1.96 * record[f'{name}_error']:.2g}"
        for name, digits in (("natural_period", 4), ("half_bandwidth", 3))
    )
    return f"natural period {period} s, half-bandwidth {bandwidth} Hz"


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
    least = [
        min((error, name) for name, error in expected.items()) for expected in both if expected
    ]
    if len(least) < len(both):
        return f"{text}: the record has no place in the map, so what it costs is not known"
    (without, best_without), (known, best_known) = least
    verdict = "it does not matter at this period and size"
    if without > (1.0 + LEAST_MARGIN) * known:
        verdict = "it matters, so let the filters know it"
    elif known > (1.0 + LEAST_MARGIN) * without:
        verdict = "the motion is so small that filters do better if they take the IMU for level"
    period = record["natural_period"]
    unit = "m/s" if find_measure(config) == "velocity" else "m"
    share = abs(make_sensors(config.sensors).lean) * (period / (2.0 * np.pi)) ** 2
    return (
        f"{text} is {100.0 * share:.2g} % of the acceleration at {period:.3g} s; the least "
        f"expected error is {np.sqrt(without):.3g} {unit} ({best_without}) if the filters do not "
        f"know it, {np.sqrt(known):.3g} {unit} ({best_known}) if they do: {verdict}"
    )
