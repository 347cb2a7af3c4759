"""Regret: what a scheme costs if nobody knows which of several worlds is true.

The regret of a scheme in a cell and a world is its error over the least error of any contender
there. Over the worlds it has a mean, by their weights, and a worst. A scheme that is best wherever
the truth is known may have a large regret; the one with the least is the one to run blind. Source:
Savage (1951), The theory of statistical decision, J. Am. Stat. Assoc. 46: minimax regret; here
errors are divided, not subtracted, so that cells and units compare.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config.over import NOMINAL, Over, list_weights, name_worlds
from owtsweep.results.answer import count_names
from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube, join_lines
from owtsweep.statistics.inference import percentile_interval, resample_means

if TYPE_CHECKING:
    import pandas as pd

#: The tables, and their columns after those of the conditions.
REGRET, SUMMARY, WORLDS = "regret", "regret_summary", "worlds"
COLUMNS = (
    "criterion", "window", "world", "weight", "scheme", "error", "least", "best", "regret", "low",
    "high", "n",
)  # fmt: skip
SUMMARY_COLUMNS = (
    "criterion", "window", "scheme", "mean", "mean_low", "mean_high", "worst", "worst_low",
    "worst_high", "worst_world", "least_mean", "least_worst", "n",
)  # fmt: skip
#: Of the draws of records: the same in all cells, schemes and worlds, which are paired.
DRAWS = (41,)


class Judged(NamedTuple):
    """By what schemes are judged: the name of the criterion, what it is, and the window."""

    name: str
    criterion: Criterion
    window: str


def make_regret(
    cubes: Mapping[str, Cube], over: Over, judged: Judged, sentences: Mapping[str, str]
) -> dict[str, pd.DataFrame]:
    """Make the tables "regret", "regret_summary" and "worlds".

    The first has a line for each cell, world and scheme: conditions and `COLUMNS`; `best` has the
    least error of the world. The second has a line for each cell and scheme: conditions and
    `SUMMARY_COLUMNS`. Ranges hold 95 % of the resamples of records. All is over the `n` records
    that all schemes of a cell have in all worlds; a scheme without records in a world has no regret
    over the worlds. The third has world, weight, and in words what departs there.

    cubes: World -> the values of all schemes and baselines. A world without any has no part.
    over: the key `over`, which has the worlds' weights.
    sentences: World -> what departs there, in words.
    """
    import pandas as pd

    if not cubes:
        return {}
    named = dict(zip(name_worlds(over), list_weights(over), strict=True))
    total = math.fsum(named[world] for world in cubes)
    weights = [named[world] / total for world in cubes]
    names = next(iter(cubes.values())).names
    schemes = list(dict.fromkeys(name for cube in cubes.values() for name in cube.schemes))
    tables = {world: cube.widen(judged.name, judged.window) for world, cube in cubes.items()}
    whole = pd.concat(tables, names=["world"])
    lines: list[pd.DataFrame] = []
    summaries: list[pd.DataFrame] = []
    index = pd.MultiIndex.from_product([[*cubes], schemes], names=["world", "scheme"])
    for place, cell in whole.groupby(names, sort=True):
        there = cell.droplevel([*names]).reindex(index)
        values = there.to_numpy().reshape(len(cubes), len(schemes), -1)
        labels = {**dict(zip(names, place, strict=True)), "criterion": judged.name}
        labels["window"] = judged.window
        found = _find_regret(judged.criterion.judge(values), np.array(weights), judged.criterion)
        lines.append(_list_worlds(labels, found, [*cubes], weights, schemes))
        summaries.append(_list_schemes(labels, found, [*cubes], schemes))
    return {
        REGRET: join_lines(lines, [*names, *COLUMNS]),
        SUMMARY: join_lines(summaries, [*names, *SUMMARY_COLUMNS]),
        WORLDS: pd.DataFrame(
            {"world": [*cubes], "weight": weights, "departs": [sentences[w] for w in cubes]}
        ),
    }


class _Found(NamedTuple):
    """Errors and regrets (worlds, schemes), those over the worlds (schemes,), and their ranges."""

    error: Array
    regret: Array
    range: Array
    mean: Array
    mean_range: Array
    worst: Array
    worst_range: Array
    n: int


def _find_regret(values: Array, weights: Array, criterion: Criterion) -> _Found:
    """Compute the regrets of one cell from what is judged, shape (worlds, schemes, records)."""
    worlds, schemes, _ = values.shape
    finite = np.isfinite(values)
    takes_part = finite.any(axis=-1, keepdims=True)
    common = np.logical_and.reduce(finite | ~takes_part, axis=(0, 1))
    shared = values[..., common]
    n = shared.shape[-1]
    drawn = [resample_means(of_world.T, DRAWS) for of_world in shared]
    draws = criterion.express(np.stack(drawn, axis=1))
    error = criterion.express(shared.mean(axis=-1)) if n else np.full((worlds, schemes), np.nan)
    regret, regrets = _divide(error), _divide(draws)
    mean, worst = np.tensordot(weights, regret, 1), regret.max(axis=0)
    means = np.einsum("w,dws->ds", weights, regrets)
    worsts = regrets.max(axis=1)
    return _Found(
        error, regret, _find_ranges(regrets), mean, _find_ranges(means), worst,
        _find_ranges(worsts), n,
    )  # fmt: skip


def _divide(error: Array) -> Array:
    """Return errors (..., worlds, schemes) over the least one of the world."""
    least = np.where(np.isfinite(error), error, np.inf).min(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(error / least)


def _find_ranges(draws: Array) -> Array:
    """Return the ends of the central 95 % of draws (draws, ...), shape (2, ...)."""
    if len(draws) == 0:
        return np.full((2, *draws.shape[1:]), np.nan)
    flat = draws.reshape(len(draws), -1).T
    ends = [
        percentile_interval(each) if np.isfinite(each).all() else (np.nan, np.nan) for each in flat
    ]
    return np.array(ends).T.reshape(2, *draws.shape[1:])


def _list_worlds(
    labels: Mapping[str, object],
    found: _Found,
    worlds: Sequence[str],
    weights: Sequence[float],
    schemes: Sequence[str],
) -> pd.DataFrame:
    import pandas as pd

    count = len(schemes)
    filled = np.where(np.isfinite(found.error), found.error, np.inf)
    best, least = filled.argmin(axis=1), filled.min(axis=1)
    table = pd.DataFrame({
        **labels,
        "world": np.repeat(np.array(worlds, dtype=object), count),
        "weight": np.repeat(weights, count),
        "scheme": np.tile(np.array(schemes, dtype=object), len(worlds)),
        "error": found.error.ravel(),
        "least": np.repeat(least, count),
        "best": np.repeat(np.array(schemes, dtype=object)[best], count),
        "regret": found.regret.ravel(),
        "low": found.range[0].ravel(),
        "high": found.range[1].ravel(),
        "n": found.n,
    })  # fmt: skip
    return table.loc[np.isfinite(found.error.ravel())]


def _list_schemes(
    labels: Mapping[str, object], found: _Found, worlds: Sequence[str], schemes: Sequence[str]
) -> pd.DataFrame:
    import pandas as pd

    there = np.isfinite(found.worst)
    if not there.any():
        return pd.DataFrame()
    least_mean, least_worst = (
        np.arange(len(schemes)) == np.where(there, each, np.inf).argmin()
        for each in (found.mean, found.worst)
    )
    table = pd.DataFrame({
        **labels,
        "scheme": np.array(schemes, dtype=object),
        "mean": found.mean,
        "mean_low": found.mean_range[0],
        "mean_high": found.mean_range[1],
        "worst": found.worst,
        "worst_low": found.worst_range[0],
        "worst_high": found.worst_range[1],
        "worst_world": np.array(worlds, dtype=object)[
            np.where(np.isfinite(found.regret), found.regret, -np.inf).argmax(axis=0)
        ],
        "least_mean": least_mean,
        "least_worst": least_worst,
        "n": found.n,
    })  # fmt: skip
    return table.loc[there]


def tell_regret(tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return sentences on who regrets least over the worlds; none without such tables."""
    if SUMMARY not in tables or tables[SUMMARY].empty:
        return []
    summary, worlds = tables[SUMMARY], tables[WORLDS]
    equal = np.ptp(worlds["weight"]) < 1e-9
    over = f"over {len(worlds)} worlds, {'equal' if equal else 'declared'} weights"
    worst = summary.loc[summary["least_worst"], "worst_world"].value_counts().index[0]
    departs = str(worlds.set_index("world")["departs"][worst])
    where = "" if worst == NOMINAL else f" ({worst}: {departs})"
    return [
        f"If nobody knows the world ({over}): {_tell_chosen(summary, 'mean')}.",
        f"Least worst regret: {_tell_chosen(summary, 'worst')}{where}.",
        "Regret: a scheme's error over the least of all schemes and baselines in that world.",
    ]


def _tell_chosen(summary: pd.DataFrame, kind: str) -> str:
    """Tell who has the least mean or worst regret: in a cell with its range, else in how many."""
    chosen = summary[summary[f"least_{kind}"]]
    word = "least mean regret " if kind == "mean" else ""
    if len(chosen) == 1:
        row = chosen.iloc[0]
        where = f" in {row['worst_world']}" if kind == "worst" else ""
        return (
            f"{word}{row['scheme']}, {row[kind]:.3g}{where} (95 %: {row[f'{kind}_low']:.3g} to "
            f"{row[f'{kind}_high']:.3g}), {row['n']} records"
        )
    names = count_names(chosen["scheme"])
    sizes = chosen[kind]
    text = (
        f"{word}{names} of {len(chosen)} cells, {sizes.min():.3g} to {sizes.max():.3g}, median "
        f"{sizes.median():.3g}"
    )
    if kind == "worst":
        text += f"; most often in {chosen['worst_world'].value_counts().index[0]}"
    return text


def make_map_table(
    summary: pd.DataFrame, conditions: Sequence[Condition], kind: str
) -> pd.DataFrame:
    """Return the table that a map draws: who has the least regret, the next, and both regrets.

    `kind` is "mean" or "worst". Nobody has won: the column `verdict` is empty.
    """
    import pandas as pd

    names = [condition.name for condition in conditions]
    rows = []
    for place, cell in summary.groupby(names, sort=False):
        ranked = cell.sort_values(kind, kind="stable")
        first, second = ranked.iloc[0], ranked.iloc[1] if len(ranked) > 1 else None
        rows.append({
            **dict(zip(names, place, strict=True)),
            "criterion": first["criterion"],
            "window": first["window"],
            "best": first["scheme"],
            "runner_up": "" if second is None else second["scheme"],
            "error_best": first[kind],
            "error_runner_up": np.nan if second is None else second[kind],
            "verdict": "",
        })  # fmt: skip
    return pd.DataFrame(rows)
