"""Advise which scheme to run, by how much it beats the runner-up, and whether the margin matters.

Schemes are compared in pairs on the same data: record by record, replicate by replicate, or, if
everything was recorded, part by part of the settled record. All are judged in one window: a scheme
that needs time to start, as SKFA does, is judged while it starts.

Recommended is the simplest of those schemes and baselines that are not worse; a baseline, if it
cannot be told apart from a scheme. Worse is an error larger than the least one by a difference that
matters: by `LEAST_MARGIN` at least, with a 95 % interval above zero, or by `LARGE_MARGIN`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.results.verdicts import SEPARATOR
from owtsweep.statistics.contest import find_alike, find_common, rank
from owtsweep.statistics.inference import mean_and_error, t_quantile
from owtsweep.studies.hub.public import BASELINES
from owtsweep.studies.replay.measures import BASELINE_ROWS

COLUMNS = (
    "file", "source", "criterion", "window", "best", "same_as", "runner_up", "value_best",
    "value_runner_up", "margin", "difference", "ci_low", "ci_high", "n", "matters", "noise",
    "recommended", "value_recommended", "recommended_ci_low", "recommended_ci_high", "left",
    "counts", "baseline", "value_baseline", "baseline_difference",
    "baseline_ci_low", "baseline_ci_high", "fit_share", "advises", "contradicts_record",
)  # fmt: skip
#: A margin (an error / the least error - 1) below this does not matter for the choice.
LEAST_MARGIN = 0.05
#: A margin of at least this matters even if the interval holds zero. The errors of a gap of fixes
#: lie in one part of a record, and make the interval wide whatever the mean says.
LARGE_MARGIN = 1.0
#: With fewer pairs than this, an interval says too little, and only the margin decides.
FEWEST_PAIRS = 5
#: The map advises for a record only if the fitted spectrum covers this share of its variance. A
#: curve of the right shape covers 0.87, and a curve fitted to one of two equal peaks some 0.56.
LEAST_COVERED = 0.6


def compare(
    samples: Array, schemes: Sequence[str], *, whole: Array | None = None
) -> dict[str, object] | None:
    """Find the best scheme and the runner-up, and whether the difference of their errors matters.

    It matters if its 95 % interval lies above zero and the margin, difference / best error, is at
    least `LEAST_MARGIN`; with a single sample only the margin decides.

    samples: mean squared errors of n replicates or parts, (schemes, n); NaN: no value.
    whole: those by which schemes are ranked, (schemes,); by default the means of the samples.
    Returns the columns of the table of advice from `best` to `matters`, with an empty `runner_up`
        if no scheme differs from the best; None if no scheme has a value.
    """
    took_part, common = find_common(samples[:, np.newaxis])
    if not took_part.any() or not common.any():
        return None
    kept = np.compress(common[0], samples, axis=1)
    mean = kept.mean(axis=1) if whole is None else whole
    alike = find_alike(samples[:, np.newaxis], took_part, common)
    ranking = rank(mean[:, np.newaxis], alike, took_part)
    best, second = int(ranking.best[0]), int(ranking.runner_up[0])
    same = np.flatnonzero(ranking.like_best[:, 0])
    row: dict[str, object] = {
        "best": schemes[best],
        "same_as": " ".join(schemes[int(i)] for i in same if i != best),
        "value_best": float(mean[best]),
        "n": int(kept.shape[1]),
    }
    if not ranking.told_apart[0]:
        return row | {"runner_up": "", "matters": False}
    difference, half = _compare(kept, mean, second, best)
    margin = difference / float(mean[best])
    excludes_zero = kept.shape[1] == 1 or difference - half > 0.0
    return row | {
        "runner_up": schemes[second],
        "value_runner_up": float(mean[second]),
        "margin": margin,
        "difference": difference,
        "ci_low": difference - half,
        "ci_high": difference + half,
        "matters": excludes_zero and margin >= LEAST_MARGIN,
    }


def advise(
    values: pd.DataFrame,
    schemes: Mapping[str, int],
    criterion: str,
    window: str,
    by: str = "replicate",
) -> dict[str, object] | None:
    """Advise which scheme to run, from the schemes' errors; None if there are none.

    Without reference position, squared distances to later fixes take the place of errors.

    values: the rows of results, with those of baselines (`BASELINE_ROWS`).
    schemes: name -> how simple it is (`Listed.simplicity`).
    by: the column that tells samples apart: "replicate" of one record, or "file".
    """
    measures = set(values["measure"])
    source = "record"
    if criterion not in measures:
        criterion, source = "fix_residual", "fixes"
    rows = values[values["measure"] == criterion]
    # of a baseline that is a scheme too the rows are the scheme's
    others = {row: name for row, name in BASELINE_ROWS.items() if name not in schemes}
    entrants = [*schemes, *others]
    samples = _pivot(rows[rows["window"] == window], entrants, by)
    whole = None
    if samples.shape[1] == 1:  # one replicate: use the parts of the settled record
        parts = _pivot(rows[rows["window"].str.startswith("part_")], entrants, "window")
        if parts.shape[1] > 1:
            window = "settled"
            whole = _pivot(rows[rows["window"] == window], entrants, by)[:, 0]
            samples = parts
    judged = judge(samples, [*schemes, *others.values()], schemes, whole=whole)
    row = {"source": source, "criterion": criterion, "window": window}
    return judged and {**row, **judged, "advises": True, "counts": True}


def judge(
    samples: Array, names: Sequence[str], schemes: Mapping[str, int], *, whole: Array | None = None
) -> dict[str, object] | None:
    """Return what `compare` finds of schemes, and `choose_simplest` of these and the baselines.

    Arguments are those of `choose_simplest`; in `names` the schemes come first.
    """
    count = len({*names} & {*schemes})
    compared = compare(samples[:count], names, whole=None if whole is None else whole[:count])
    if compared is None:
        return None
    return compared | choose_simplest(samples, names, str(compared["best"]), schemes, whole=whole)


def prefer_better(stated: dict[str, object], estimated: dict[str, object]) -> None:
    """Let the row of advice count with the noise that gives the smaller error, the stated in doubt.

    Without reference position, errors are distances from fixes that an estimate has not used: an
    estimate of the noise that lies off for want of fixes shows there.
    """
    better = float(str(estimated["value_recommended"])) < float(str(stated["value_recommended"]))
    stated["counts"], estimated["counts"] = not better, better


def _pivot(rows: pd.DataFrame, schemes: Sequence[str], column: str) -> Array:
    table = rows.pivot_table(index="scheme", columns=column, values="value", sort=True)
    return np.asarray(table.reindex(list(schemes)).to_numpy(dtype=float))


def choose_simplest(
    samples: Array,
    names: Sequence[str],
    best: str,
    schemes: Mapping[str, int],
    *,
    whole: Array | None = None,
) -> dict[str, object]:
    """Choose the simplest of the schemes and baselines that are not worse than another.

    samples: mean squared errors, (schemes and baselines, n); those are compared that have every
        value which the best scheme has.
    names: of schemes and baselines.
    best: the scheme of the least error.
    schemes: scheme -> how simple it is.
    whole: the errors of the whole record; by default the means of the samples.
    Returns the columns of the table of advice from `recommended` to `baseline_ci_high`, without
        `counts`. `left` are those that are not worse, the simplest first. `baseline` is what is
        recommended, if a baseline, else the best one ("": none); `baseline_difference` is positive
        where it beats the best scheme.
    """
    at_best = list(names).index(best)
    kept = np.compress(np.isfinite(samples[at_best]), samples, axis=1)
    able = [i for i in range(len(names)) if np.all(np.isfinite(kept[i]))]
    means = np.mean(kept, axis=1) if whole is None else whole
    least = min(able, key=lambda i: means[i])
    ranks = {**schemes, **{name: listed.simplicity for name, listed in BASELINES.items()}}
    good = [i for i in able if not _is_worse(kept, means, i, least)]
    good.sort(key=lambda i: ranks[names[i]])
    chosen, rivals = good[0], [i for i in able if names[i] in BASELINES]
    half = np.nan if whole is not None else _measure_half(kept[chosen])
    row: dict[str, object] = {
        "recommended": names[chosen],
        "value_recommended": float(means[chosen]),
        "recommended_ci_low": max(float(means[chosen]) - half, 0.0),
        "recommended_ci_high": float(means[chosen]) + half,
        "left": SEPARATOR.join(names[i] for i in good),
        "baseline": "",
    }
    if not rivals:
        return row
    rival = chosen if chosen in rivals else min(rivals, key=lambda i: means[i])
    difference, half = _compare(kept, means, at_best, rival)
    return row | {
        "baseline": names[rival],
        "value_baseline": float(means[rival]),
        "baseline_difference": difference,
        "baseline_ci_low": difference - half,
        "baseline_ci_high": difference + half,
    }


def _is_worse(samples: Array, means: Array, one: int, other: int) -> bool:
    difference, half = _compare(samples, means, one, other)
    if difference == 0.0 or not difference >= LEAST_MARGIN * means[other]:
        return False
    few = samples.shape[1] < FEWEST_PAIRS
    return few or bool(difference > half or difference >= LARGE_MARGIN * means[other])


def _compare(samples: Array, means: Array, one: int, other: int) -> tuple[float, float]:
    return float(means[one] - means[other]), _measure_half(samples[one] - samples[other])


def _measure_half(values: Array) -> float:
    # of the 95 % interval of their mean
    _, error, n = mean_and_error(values)
    return float(t_quantile(n - 1) * error)


def relate_to_record(
    values: Mapping[str, float], by_record: Mapping[str, object] | None, share: float
) -> dict[str, object]:
    """Return the columns fit_share, advises and contradicts_record of the table of advice.

    The map contradicts the record if what the record recommends has, by the map, an error larger
    than the least one by `LEAST_MARGIN` or more.

    values: scheme or baseline -> its error by the map.
    by_record: the row by the record's own errors, if there is one.
    share: of the record's variance that the fitted spectrum covers.
    """
    chosen = "" if by_record is None else str(by_record["recommended"])
    least = min(values.values())
    excess = values.get(chosen, least) - least
    return {
        "fit_share": share,
        "advises": bool(share >= LEAST_COVERED),
        "contradicts_record": bool(excess >= LEAST_MARGIN * least > 0.0),
    }
