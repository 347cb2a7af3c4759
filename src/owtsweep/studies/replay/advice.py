"""Advise which scheme to run, by how much it beats the runner-up, and whether the margin matters.

Schemes are compared in pairs on the same data. If noise was simulated, they are compared replicate
by replicate. If everything was recorded, there is a single replicate; then schemes are compared
part by part of the settled record.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.contest import find_alike, rank
from owtsweep.statistics.student import t_quantile
from owtsweep.statistics.sums import mean_and_error

if TYPE_CHECKING:
    import pandas as pd

#: A margin (runner-up's MSE / best MSE - 1) of at least this is stated as a factor, not in percent.
MARGIN_IN_TIMES = 2.0
#: A smaller margin does not matter for the choice of a scheme.
LEAST_MARGIN = 0.05

COLUMNS = (
    "file", "source", "criterion", "window", "best", "same_as", "runner_up", "value_best",
    "value_runner_up", "margin", "difference", "ci_low", "ci_high", "n", "matters", "noise",
)  # fmt: skip


def compare(
    samples: Array, schemes: Sequence[str], *, whole: Array | None = None
) -> dict[str, Any] | None:
    """Find the best scheme and the runner-up, and whether the difference of their errors matters.

    Parameters
    ----------
    samples
        Mean squared errors, shape (schemes, n), in n replicates or in n parts of a record; NaN
        where a scheme has no value.
    schemes
        Names of the schemes.
    whole
        The mean squared errors by which schemes are ranked, shape (schemes,). If None, the means of
        the samples are used. Needed if the samples are parts of a record: the samples then only
        give the interval.

    Returns
    -------
    dict or None
        The columns of the table of advice from `best` to `matters` (see `COLUMNS`). None if no
        scheme has a value. If no scheme differs from the best scheme, `runner_up` is "", `matters`
        is False, and the numbers on the runner-up are left out.

    Notes
    -----
    The difference matters if its 95 % interval lies above zero and the margin, which is difference
    / best error, is at least `LEAST_MARGIN`. With a single sample there is no interval, and only
    the margin decides.
    """
    common = np.isfinite(samples).any(axis=0)
    took_part = np.flatnonzero(np.isfinite(samples[:, common]).any(axis=1))
    common &= np.isfinite(samples[took_part]).all(axis=0)
    if len(took_part) == 0 or not np.any(common):
        return None
    kept = samples[np.ix_(took_part, common)]
    mean = kept.mean(axis=1) if whole is None else whole[took_part]
    everybody = np.ones((len(kept), 1), dtype=bool)
    alike = find_alike(kept[:, np.newaxis], everybody, np.ones((1, kept.shape[1]), dtype=bool))
    ranking = rank(mean[:, np.newaxis], alike, everybody)
    best, second = int(ranking.best[0]), int(ranking.runner_up[0])
    same = np.flatnonzero(ranking.like_best[:, 0])
    names = [schemes[int(i)] for i in took_part]
    row: dict[str, Any] = {
        "best": names[best],
        "same_as": " ".join(names[i] for i in same if i != best),
        "value_best": float(mean[best]),
        "n": int(kept.shape[1]),
    }
    if not ranking.told_apart[0]:
        return row | {"runner_up": "", "matters": False}
    _, error, n = mean_and_error(kept[second] - kept[best])
    difference = mean[second] - mean[best]
    half = float(t_quantile(n - 1) * error) if n > 1 else np.nan
    margin = float(difference / mean[best])
    excludes_zero = bool(difference - half > 0.0) if n > 1 else True
    return row | {
        "runner_up": names[second],
        "value_runner_up": float(mean[second]),
        "margin": margin,
        "difference": float(difference),
        "ci_low": float(difference) - half,
        "ci_high": float(difference) + half,
        "matters": excludes_zero and margin >= LEAST_MARGIN,
    }


def advise_from_record(
    values: pd.DataFrame, schemes: Sequence[str], criterion: str, window: str
) -> dict[str, Any] | None:
    """Advise which scheme to run, from the schemes' errors on one record.

    If the record has no reference position, squared distances to later position fixes are used
    instead of errors. Returns None if no scheme has a value.

    Parameters
    ----------
    values
        The rows of results on the record, with the columns scheme, replicate, measure, window,
        value.
    schemes
        Names of the schemes to compare.
    criterion
        The measure to compare, e.g. "position".
    window
        The part of the record over which the measure is averaged: "full" or "settled".
    """
    measures = set(values["measure"])
    source = "record"
    if criterion not in measures:
        criterion, source = "fix_residual", "fixes"
    rows = values[values["measure"] == criterion]
    samples = _pivot(rows[rows["window"] == window], schemes, "replicate")
    whole = None
    if samples.shape[1] == 1:  # one replicate: use the parts of the settled record
        parts = _pivot(rows[rows["window"].str.startswith("part_")], schemes, "window")
        if parts.shape[1] > 1:
            window = "settled"
            whole = _pivot(rows[rows["window"] == window], schemes, "replicate")[:, 0]
            samples = parts
    compared = compare(samples, schemes, whole=whole)
    if compared is None:
        return None
    return {"source": source, "criterion": criterion, "window": window, **compared}


def _pivot(rows: pd.DataFrame, schemes: Sequence[str], column: str) -> Array:
    table = rows.pivot_table(index="scheme", columns=column, values="value", sort=True)
    return np.asarray(table.reindex(list(schemes)).to_numpy(dtype=float))


def write_sentence(row: Any) -> str:
    """Write one row of the table of advice as a sentence, for the report and the terminal."""
    where = {
        "record": "this record's own errors",
        "fixes": "the distance from the fixes that came later",
        "map": "the expected map at its period and amplitude",
    }[row["source"]]
    if row.get("noise") == "estimated":
        where += " with the estimated noise"
    best = row["best"] + (f" (= {row['same_as'].replace(' ', ' = ')})" if row["same_as"] else "")
    root = np.sqrt(row["value_best"])
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    size = f"{row['value_best']:.3g} {unit.replace('m', 'm²', 1).replace('/s', '/s²')}"
    if row["criterion"] == "fix_residual":
        size += f" from a fix, its noise included (root {root:.2g} {unit})"
    else:
        size += f" {row['criterion']} MSE (root {root:.2g} {unit})"
    if not row["runner_up"]:
        return f"by {where}: {best}, {size}; there is nothing to compare it with"
    margin = f"{row['runner_up']} has {_describe_margin(row)}"
    if not row["matters"]:
        return f"by {where}: no difference that matters; {best}, {size}; {margin}"
    return f"by {where}: run {best}, {size}; {margin}"


def _describe_margin(row: Any) -> str:
    """Say how much larger the runner-up's MSE is: in per cent, or as a factor for a large margin.

    `row` is a row of the table of advice.
    """
    parts = [row["margin"]]
    if row["source"] != "map" and np.isfinite(row["ci_low"]):
        parts += [row[key] / row["value_best"] for key in ("ci_low", "ci_high")]
    if row["margin"] >= MARGIN_IN_TIMES:
        told, unit, word = [f"{1.0 + part:.3g}" for part in parts], "times", "as much"
    else:
        told, unit, word = [f"{100.0 * part:.3g}" for part in parts], "%", "more"
    interval = f" (95 %: {told[1]} to {told[2]} {unit})" if len(told) > 1 else ""
    return f"{told[0]} {unit} {word}{interval}"
