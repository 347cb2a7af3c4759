"""Advise which scheme to run, by how much it beats the runner-up, and whether the margin matters.

Schemes are compared in pairs on the same data. If noise was simulated, they are compared replicate
by replicate. If everything was recorded, there is a single replicate; then schemes are compared
part by part of the settled record.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.contest import find_alike, rank
from owtsweep.statistics.inference import mean_and_error, t_quantile
from owtsweep.studies.hub.public import INSTEAD
from owtsweep.studies.replay import choosing
from owtsweep.studies.replay.baselines import BASELINE_ROWS
from owtsweep.studies.replay.choosing import LEAST_MARGIN
from owtsweep.studies.replay.identification.rows import ESTIMATED

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "file", "source", "criterion", "window", "best", "same_as", "runner_up", "value_best",
    "value_runner_up", "margin", "difference", "ci_low", "ci_high", "n", "matters", "noise",
    *choosing.COLUMNS,
)  # fmt: skip
#: What the root of a criterion's mean square is called.
ERRORS = {
    "position": "position error",
    "velocity": "velocity error",
    "fix_residual": "distance from later fixes",
}


def compare(
    samples: Array, schemes: Sequence[str], *, whole: Array | None = None
) -> dict[str, object] | None:
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
    row: dict[str, object] = {
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
) -> dict[str, object] | None:
    """Advise which scheme to run, from the schemes' errors on one record.

    If the record has no reference position, squared distances to later position fixes are used
    instead of errors. Returns None if no scheme has a value.

    Parameters
    ----------
    values
        The rows of results on the record, with the columns scheme, replicate, measure, window,
        value. Rows of baselines have a value of scheme that is in `BASELINE_ROWS`; without such
        rows, baselines are not considered.
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
    entrants = [*schemes, *BASELINE_ROWS]
    samples = _pivot(rows[rows["window"] == window], entrants, "replicate")
    whole = None
    if samples.shape[1] == 1:  # one replicate: use the parts of the settled record
        parts = _pivot(rows[rows["window"].str.startswith("part_")], entrants, "window")
        if parts.shape[1] > 1:
            window = "settled"
            whole = _pivot(rows[rows["window"] == window], entrants, "replicate")[:, 0]
            samples = parts
    count = len(schemes)
    compared = compare(samples[:count], schemes, whole=None if whole is None else whole[:count])
    if compared is None:
        return None
    names = [*schemes, *BASELINE_ROWS.values()]
    chosen = choosing.recommend(samples, names, str(compared["best"]), whole=whole)
    told = {"source": source, "criterion": criterion, "window": window}
    return {**told, **compared, **chosen, "advises": True}


def _pivot(rows: pd.DataFrame, schemes: Sequence[str], column: str) -> Array:
    table = rows.pivot_table(index="scheme", columns=column, values="value", sort=True)
    return np.asarray(table.reindex(list(schemes)).to_numpy(dtype=float))


def recommend(advised: pd.DataFrame) -> str:
    """Write the recommendation for one record as one sentence; "" if there is no advice.

    The record's own errors, or its fixes, count before the expected map. If the record contradicts
    the stated noise, so that the schemes were run with the estimated noise too, that run counts.
    `advised` is the table of advice of a run with a single record.
    """
    if advised.empty:
        return ""
    own = advised[advised["source"] != "map"]
    if (own["noise"] == ESTIMATED).any():
        own = own[own["noise"] == ESTIMATED]
    row = (own if len(own) else advised).iloc[0].dropna().to_dict()
    if not row["advises"]:
        return ""  # the map covers too little of the record
    unit = "m/s" if row["criterion"] == "velocity" else "m"
    what = ERRORS.get(row["criterion"], f"error of {row['criterion']}")
    chosen, size = row["recommended"], np.sqrt(row["value_recommended"])
    what_to_do = f"{INSTEAD[chosen]} ({chosen})" if chosen in INSTEAD else f"run {chosen}"
    if row["noise"] == ESTIMATED:
        what_to_do += " with the noise that the record shows (noise.csv), not the stated one"
    told = f"{what_to_do}; its {what} is {size:.3g} {unit}"
    told = f"recommended: {told} (root mean square)"
    best = [row["best"], *row.get("same_as", "").split()]
    if chosen not in best:
        return f"{told}, that of {row['best']} {np.sqrt(row['value_best']):.3g} {unit}"
    if not row.get("runner_up"):
        return told
    told += f", that of {row['runner_up']} {np.sqrt(row['value_runner_up']):.3g} {unit}"
    return told if row["matters"] else f"{told}; the difference does not matter"
