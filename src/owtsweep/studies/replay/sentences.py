"""Write the rows of the table of advice as sentences, for the report and the terminal."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.studies.hub.public import BASELINES, INSTEAD

#: A margin (an error / the best error - 1) of at least this is stated as a factor, not in percent.
MARGIN_IN_TIMES = 2.0
SOURCES = {
    "record": "this record's own errors",
    "fixes": "the distance from the fixes that came later",
    "map": "the expected map at its period and amplitude",
}


def write_sentence(row: Any) -> str:
    """Write one row of the table of advice as a sentence that begins with what is recommended.

    Columns about baselines and coverage may be missing, as in a table stored before these existed.
    """
    clean = {name: value for name, value in row.items() if value == value}
    noise = " with the estimated noise" if clean.get("noise") == "estimated" else ""
    text = f"by {SOURCES[row['source']]}{noise}: {_recommend(clean)}"
    if row["source"] != "map" or "fit_share" not in clean:
        return text
    covered = f"{100.0 * row['fit_share']:.0f} % of the variance"
    if row["advises"]:
        text += f"; the fit of Eq. (1) covers {covered}"
    else:
        text = f"no advice, only for the {covered} that the fit of Eq. (1) covers: {text}"
    if row["contradicts_record"]:
        text += "; this contradicts the record's own errors, which count because they judge all of "
        text += "its motion"
    return text


def _recommend(row: dict[str, Any]) -> str:
    """Say what is recommended, its error, and the errors of what comes next."""
    chosen = row.get("recommended", row["best"])
    if chosen in BASELINES and row.get("baseline") == chosen:
        return _recommend_baseline(row, chosen)
    value = row.get("value_recommended", row["value_best"])
    size = _describe_size(row, value)
    same = row["same_as"].split()
    best = _name(row["best"], same)
    more = f"; {rival}" if (rival := _describe_rival(row)) else ""
    if chosen != row["best"] and chosen not in same:
        ends = []
        if chosen == row["runner_up"] and row["source"] != "map" and "ci_low" in row:
            ends = [-row["ci_high"], -row["ci_low"]]
        less = f"{best} has {_describe_difference(row['value_best'] - value, value, *ends)}"
        return f"no difference that matters: run {chosen}, the simplest, {size}; {less}{more}"
    if not row["runner_up"]:
        return f"{best}, {size}; there is nothing to compare it with{more}"
    ends = [row[end] for end in ("ci_low", "ci_high") if row["source"] != "map" and end in row]
    told = _describe_difference(row["margin"] * row["value_best"], row["value_best"], *ends)
    margin = f"{row['runner_up']} has {told}"
    if not row["matters"]:
        return f"no difference that matters; {best}, {size}; {margin}{more}"
    return f"run {best}, {size}; {margin}{more}"


def _recommend_baseline(row: dict[str, Any], chosen: str) -> str:
    """Say that a baseline is recommended, and how far the best scheme is from its error."""
    value, best = row["value_baseline"], _name(row["best"], row["same_as"].split())
    ends = [
        row[end]
        for end in ("baseline_ci_low", "baseline_ci_high")
        if row["source"] != "map" and end in row
    ]
    told = _describe_difference(row["baseline_difference"], value, *ends)
    better = "no scheme is better"
    if row["baseline_difference"] < 0.0:
        better += " by a difference that matters"
    size = _describe_size(row, value)
    if best == chosen:  # a baseline that stands among the schemes
        return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}"
    return f"{INSTEAD[chosen]} ({chosen}), {size}: {better}; {best}, the best scheme, has {told}"


def _describe_rival(row: dict[str, Any]) -> str:
    """Say how much larger the error of the best baseline is; "" if no baseline was judged."""
    if not row.get("baseline") or row["baseline"] == row["best"]:
        return ""
    told = _describe_difference(row["value_baseline"] - row["value_best"], row["value_best"])
    return f"{row['baseline']}, the best baseline, has {told}"


def _name(best: str, same: list[str]) -> str:
    return f"{best} (= {' = '.join(same)})" if same else best


def _describe_size(row: dict[str, Any], value: float) -> str:
    """Say how large a mean squared error is, with its unit and its root."""
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    size = f"{value:.3g} {unit.replace('m', 'm²', 1).replace('/s', '/s²')}"
    if row["criterion"] == "fix_residual":
        return size + f" from a fix, its noise included (root {np.sqrt(value):.2g} {unit})"
    return size + f" {row['criterion']} MSE (root {np.sqrt(value):.2g} {unit})"


def _describe_difference(difference: float, base: float, *ends: float) -> str:
    """Say by how much an error differs from another one: in per cent, or as a factor if large.

    Parameters
    ----------
    difference
        The error minus `base`.
    base
        The other error.
    ends
        The lower and the upper end of the 95 % interval of `difference`; nothing if there is none.
    """
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
