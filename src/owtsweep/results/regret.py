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
from typing import TYPE_CHECKING, Any, NamedTuple

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
    weights = {world: named[world] / total for world in cubes}
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
        labels: dict[str, Any] = dict(zip(names, place, strict=True))
        labels |= {"criterion": judged.name, "window": judged.window}
        found = _find_regret(judged.criterion.judge(values), judged.criterion, weights, schemes)
        lines.append(found[0].assign(**labels))
        summaries.append(found[1].assign(**labels))
    columns, summed = [*names, *COLUMNS], [*names, *SUMMARY_COLUMNS]
    departs = [sentences[world] for world in cubes]
    return {
        REGRET: join_lines(lines, columns)[columns],
        SUMMARY: join_lines(summaries, summed)[summed],
        WORLDS: pd.DataFrame({"world": [*cubes], "weight": weights.values(), "departs": departs}),
    }


def _find_regret(
    values: Array, criterion: Criterion, weights: Mapping[str, float], schemes: Sequence[str]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Compute the lines of one cell in the tables "regret" and "regret_summary", without labels.

    values: what is judged, shape (worlds, schemes, records).
    weights: World -> its weight.
    """
    import pandas as pd

    count, weight = len(schemes), np.array([*weights.values()])
    names, worlds = np.array(schemes, dtype=object), np.array([*weights], dtype=object)
    finite = np.isfinite(values)
    takes_part = finite.any(axis=-1, keepdims=True)
    shared = values[..., (finite | ~takes_part).all(axis=(0, 1))]
    n = shared.shape[-1]
    drawn = [resample_means(of_world.T, DRAWS) for of_world in shared]
    error = criterion.express(shared.mean(axis=-1)) if n else np.full(values.shape[:2], np.nan)
    regret, regrets = _divide(error), _divide(criterion.express(np.stack(drawn, axis=1)))
    known = np.where(np.isfinite(error), error, np.inf)
    # of each world
    low, high = _find_ranges(regrets)
    of_worlds = pd.DataFrame({
        "world": np.repeat(worlds, count),
        "weight": np.repeat(weight, count),
        "scheme": np.tile(names, len(worlds)),
        "error": error.ravel(),
        "least": np.repeat(known.min(axis=1), count),
        "best": np.repeat(names[known.argmin(axis=1)], count),
        "regret": regret.ravel(),
        "low": low.ravel(),
        "high": high.ravel(),
        "n": n,
    })  # fmt: skip
    # over the worlds
    mean, worst = np.tensordot(weight, regret, 1), regret.max(axis=0)
    mean_low, mean_high = _find_ranges(np.einsum("w,dws->ds", weight, regrets))
    worst_low, worst_high = _find_ranges(regrets.max(axis=1))
    there = np.isfinite(worst)
    least_mean, least_worst = (
        np.arange(count) == np.where(there, each, np.inf).argmin() for each in (mean, worst)
    )
    over_worlds = pd.DataFrame({
        "scheme": names,
        "mean": mean,
        "mean_low": mean_low,
        "mean_high": mean_high,
        "worst": worst,
        "worst_low": worst_low,
        "worst_high": worst_high,
        "worst_world": worlds[np.where(np.isfinite(regret), regret, -np.inf).argmax(axis=0)],
        "least_mean": least_mean,
        "least_worst": least_worst,
        "n": n,
    })  # fmt: skip
    return of_worlds[np.isfinite(of_worlds["error"])], over_worlds[there]


def _divide(error: Array) -> Array:
    """Return errors (..., worlds, schemes) over the least one of the world."""
    least = np.where(np.isfinite(error), error, np.inf).min(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(error / least)


def _find_ranges(draws: Array) -> Array:
    """Return the ends of the central 95 % of draws (draws, ...), shape (2, ...)."""
    if len(draws) == 0:
        return np.full((2, *draws.shape[1:]), np.nan)
    return np.where(np.isfinite(draws).all(axis=0), percentile_interval(draws), np.nan)


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
    cell = [*(condition.name for condition in conditions), "criterion", "window"]
    ranked = summary.sort_values(kind, kind="stable")
    rank = ranked.groupby(cell).cumcount()
    first, second = (
        ranked.loc[rank == place, [*cell, "scheme", kind]]
        .sort_index()
        .rename(columns={"scheme": who, kind: f"error_{who}"})
        for place, who in enumerate(("best", "runner_up"))
    )
    table = first.merge(second, how="left", on=cell)
    return table.assign(runner_up=table["runner_up"].fillna(""), verdict="")
