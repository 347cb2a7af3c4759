"""Decides the cells of a map by looks at more and more records, and makes the table of verdicts.

The rule is that of `owtsweep.statistics.deciding`. All schemes and baselines are contenders. A
contender that has left is not run on further records, so its error is told as that of the best
scheme, times the ratio of the two over the records that both have.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.best_scheme import ERROR_COLUMNS, VERDICT_COLUMNS, finish
from owtsweep.results.conditions import Value
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.status import UNABLE
from owtsweep.statistics.contest import agree
from owtsweep.statistics.deciding import (
    ENOUGH,
    LOOKS,
    Decision,
    Rule,
    decide,
    find_growth,
    find_level,
    find_quantile,
)
from owtsweep.statistics.inference import mean_and_error, ordered_sum, t_quantile

if TYPE_CHECKING:
    import pandas as pd

#: Columns of best_scheme.csv, after those of the conditions.
COLUMNS = (*VERDICT_COLUMNS, *ERROR_COLUMNS, "left", "more")
#: Further columns of a run with baselines: the best baseline, and its error.
BASELINE_COLUMNS = ("baseline", "error_baseline")
#: Columns that best_scheme.csv and summary.csv have both, but with another meaning.
_OTHERS = ("ci_low", "ci_high", "n", "status", "reason")
#: What stands between names in the column `left`.
SEPARATOR = "; "


@dataclass(frozen=True)
class Asked:
    """What is asked of a map.

    criteria: Measures by which schemes are judged; the first one says how many records a cell gets.
    window: the window that is judged.
    contenders: Names of schemes and baselines, the simplest first.
    baselines: Names of those that are no schemes.
    cells: Number of cells of the map.
    margin, most, ties_from: as in `statistics.deciding.Rule`.
    """

    criteria: Mapping[str, Criterion]
    window: str
    contenders: Sequence[str]
    baselines: Sequence[str]
    cells: int
    margin: float
    most: int
    ties_from: int = ENOUGH

    def make_rule(self, criterion: Criterion) -> Rule:
        return Rule(self.margin, criterion.floor, criterion.squared, self.most, self.ties_from)


class Cell(NamedTuple):
    """A cell of a map, and what its records say by one criterion.

    conditions: Condition -> value.
    names: the contenders, the simplest first.
    values: What is judged of each contender and record, shape (contenders, records); NaN where it
        failed or was not run.
    run: whether a contender was run on a record, same shape.
    """

    conditions: dict[str, Value]
    names: list[str]
    values: Array
    run: NDArray[np.bool_]


def list_cells(cube: Cube, run: NDArray[np.bool_], asked: Asked, name: str) -> Iterator[Cell]:
    """Yield the cells in which a contender was run, with their values by the criterion `name`.

    cube, run: the values of a run, and what `_find_run` returns.
    """
    criterion = asked.criteria[name]
    if cube.empty or name not in cube.measures or asked.window not in cube.windows:
        return
    records = [int(label) for label in cube.replicates]
    places = {name: place for place, name in enumerate(asked.contenders)}
    order = sorted(range(len(cube.schemes)), key=lambda i: places[cube.schemes[i]])
    for place in cube.outer_places():
        values = np.full((len(cube.schemes), len(cube.levels[-1]), run.shape[-1]), np.nan)
        values[..., records] = cube.values_of(place, name, asked.window)
        values = criterion.judge(values)
        for last, value in enumerate(cube.levels[-1]):
            here = [i for i in order if run[(i, *place, last)].any()]
            if here:
                conditions = {**cube.name_outer(place), cube.names[-1]: value}
                ran = np.stack([run[(i, *place, last)] for i in here])
                yield Cell(conditions, [cube.schemes[i] for i in here], values[here, last], ran)


def _find_run(cube: Cube, rows: pd.DataFrame) -> NDArray[np.bool_]:
    """Return on which records schemes were run, shape (schemes, *conditions, records).

    A scheme that was unable to work in a cell was not run there. A row without a value of the last
    condition stands for all its values.
    """
    import pandas as pd

    names, axes = ["scheme", *cube.names], [cube.schemes, *cube.levels]
    rows = rows[rows["scheme"].isin(list(cube.schemes)) & rows["replicate"].notna()]
    lines = rows[[*names, "replicate", "status"]].drop_duplicates()
    records = int(lines["replicate"].max()) + 1 if len(lines) else 0
    run = np.zeros((*map(len, axes), records), dtype=bool)
    *outer, last = [
        pd.Index(axis).get_indexer(pd.Index(lines[name].to_numpy()))
        for name, axis in zip(names, axes, strict=True)
    ]
    known = np.all([index >= 0 for index in outer], axis=0)
    everywhere = known & lines[names[-1]].isna().to_numpy()
    unable = (lines["status"] == UNABLE).to_numpy()
    record = lines["replicate"].to_numpy(int)
    for ran in (True, False):  # False last, because it takes back what other records say
        for here, at_one in ((everywhere, False), (known & (last >= 0), True)):
            chosen = here & (unable != ran)
            place = [index[chosen] for index in outer]
            levels = last[chosen] if at_one else slice(None)
            run[(*place, levels, record[chosen] if ran else slice(None))] = ran
    return run


def find_open(cube: Cube, rows: pd.DataFrame, asked: Asked) -> tuple[int, list[Cell]]:
    """Find the cells that need the next look, by the first criterion, and how many it sees.

    A cell does not get more records if a record of its last look is missing. The cells have those
    contenders alone that are left. Without such a cell, the number of records is 0.
    """
    name, criterion = next(iter(asked.criteria.items()))
    rule, going = asked.make_rule(criterion), []
    for cell in list_cells(cube, _find_run(cube, rows), asked, name):
        decision = decide(cell.values, rule, asked.cells, cell.run)
        if decision.verdict == "open" and decision.records < asked.most and decision.look > 0:
            left = list(decision.left)
            going.append((decision.records, cell._replace(names=[cell.names[i] for i in left])))
    records = max((count for count, _ in going), default=0)
    # a cell that is behind has lost a record of a look: the same sweep tries it again
    cells = [cell for count, cell in going if count == records]
    return (LOOKS[LOOKS.index(records) + 1] if cells else 0), cells


def make_table(cube: Cube, rows: pd.DataFrame, asked: Asked) -> pd.DataFrame:
    """Make the table best_scheme: a line per cell and criterion, sorted as `cube.conditions`.

    The columns are those of the conditions, `COLUMNS` and, with baselines, `BASELINE_COLUMNS`.
    `best` is the winner, the simplest scheme of a tie, or the best so far; `best_scheme` the same
    without baselines. `left` names the contenders of which no other is surely better. `n` records
    were seen at `look`; where the cell is open, some `more` would decide it. Errors are in the
    criterion's unit; `error_low` and `error_high` are the ends of a 95 % interval. `mse_best` is
    the mean of what is judged; `mse_runner_up`, `difference` and the 95 % interval of the
    difference are scaled to it. `runner_up` is the best of the others that do not coincide with the
    best. If a scheme was unable to work in any cell, there are also the columns `status` and
    `reason`.
    """
    import pandas as pd

    columns = [*cube.names, *COLUMNS, *(BASELINE_COLUMNS if asked.baselines else ())]
    lines, run = [], _find_run(cube, rows)
    for name, criterion in asked.criteria.items():
        rule = asked.make_rule(criterion)
        for cell in list_cells(cube, run, asked, name):
            decision = decide(cell.values, rule, asked.cells, cell.run)
            if decision.look == 0 or decision.best < 0:
                continue
            line: dict[str, object] = {**cell.conditions, "criterion": name, "window": asked.window}
            line |= _describe(cell, decision, criterion, asked.baselines)
            lines.append({**line, "more": _estimate_more(cell, decision, rule, asked.cells)})
    if not lines:
        return pd.DataFrame(columns=columns)
    return finish(pd.DataFrame(lines)[columns], cube)


def _describe(
    cell: Cell, decision: Decision, criterion: Criterion, baselines: Sequence[str]
) -> dict[str, object]:
    """Return the columns of a cell's line, besides conditions, criterion and window."""
    best, n = decision.best, decision.records
    seen = cell.values[:, :n]
    mean, error, _ = (float(part) for part in mean_and_error(seen[best]))
    half = float(t_quantile(n - 1)) * error
    compared = {i: _compare(seen[i], seen[best], mean) for i in range(len(seen)) if i != best}
    others = {i: mean + difference for i, (difference, _, _) in compared.items()}
    apart = [
        i for i in others if np.isfinite(others[i]) and not agree(seen[i], seen[best])[:n].all()
    ]
    second = min(apart, key=lambda i: others[i], default=-1)
    # of several that coincide, the simplest names them
    second = next((i for i in apart if agree(seen[i], seen[second])[:n].all()), second)
    means = {cell.names[i]: value for i, value in others.items()} | {cell.names[best]: mean}

    def choose(among: Sequence[str]) -> str:
        """Return the best one of some contenders; "" if there is none."""
        if cell.names[best] in among:
            return cell.names[best]
        known = [name for name in among if np.isfinite(means[name])]
        return min(known, key=means.__getitem__, default="")

    difference, low, high = compared.get(second, (np.nan, np.nan, np.nan))
    line: dict[str, object] = {
        "verdict": decision.verdict,
        "best": cell.names[best],
        "best_scheme": choose([name for name in cell.names if name not in baselines]),
        "runner_up": cell.names[second] if second >= 0 else "",
        "look": decision.look,
        "n": n,
        "error_best": float(criterion.express(mean)),
        "error_low": float(criterion.express(max(mean - half, 0.0) if mean >= 0.0 else mean)),
        "error_high": float(criterion.express(mean + half)),
        "error_runner_up": float(criterion.express(others.get(second, np.nan))),
        "left": SEPARATOR.join(cell.names[i] for i in decision.left),
        "mse_best": mean,
        "mse_runner_up": others.get(second, np.nan),
        "distinguishable": decision.verdict == "won",
        "difference": difference,
        "ci_low": low,
        "ci_high": high,
    }
    if baselines:
        name = choose([name for name in cell.names if name in baselines])
        line["baseline"] = name
        line["error_baseline"] = float(criterion.express(means.get(name, np.nan)))
    return line


def _estimate_more(cell: Cell, decision: Decision, rule: Rule, cells: int) -> float:
    """Estimate how many more records would decide a cell; 0 if it is decided.

    Each pair with the best needs so many that its t-value passes the next level: of a win, or of a
    tie if that is nearer.
    """
    if decision.verdict != "open":
        return 0.0
    n, best = decision.records, cell.values[decision.best, : decision.records]
    level = find_level(decision.look + 1) / (cells * max(len(cell.names) - 1, 1))
    allowed = float(best.mean() * (find_growth(best[np.newaxis], rule)[0] - 1.0))
    needed = [0.0]
    for i in decision.left:
        if i == decision.best:
            continue
        difference = cell.values[i, :n] - best
        gap = max(abs(difference.mean()), allowed - difference.mean())
        needed.append((find_quantile(level, n - 1) * difference.std(ddof=1) / gap) ** 2)
    return max(float(np.ceil(max(needed) - n)), 1.0)


def _compare(values: Array, best: Array, mean: float) -> tuple[float, float, float]:
    """Compare a contender with the best over the records that both have.

    Return the mean difference and the ends of its 95 % interval, scaled to `mean`, the best one's
    over all records. NaN if they have no record in common.
    """
    both = np.isfinite(values) & np.isfinite(best)
    if not both.any():
        return np.nan, np.nan, np.nan
    difference, error, n = mean_and_error((values - best)[both])
    half = t_quantile(n - 1) * error
    of_best = ordered_sum(best[both]) / n
    scale = mean / of_best if of_best != 0.0 else 1.0
    ends = (difference - half) * scale, (difference + half) * scale
    return float(difference * scale), float(ends[0]), float(ends[1])


def count_cells(grid: Mapping[str, Sequence[Value]]) -> int:
    return prod(len(values) for values in grid.values())


def judge_exactly(best: pd.DataFrame, summary: pd.DataFrame, asked: Asked) -> pd.DataFrame:
    """Return the table best_scheme of exact means, judged by the margin alone.

    A cell is won if every other contender that does not coincide with the best is worse by more
    than the margin. Otherwise it is a tie, for the simplest of those within the margin.

    best: the table best_scheme of `find_best_schemes`.
    summary: the table summary with the exact means.
    """
    import pandas as pd

    if best.empty:  # no scheme has an error
        return best.assign(left="")
    keys = [name for name in best.columns if name in summary.columns and name not in _OTHERS]
    judged = summary[summary["measure"].isin(list(asked.criteria))]
    means = judged.pivot(index=[*keys, "measure"], columns="scheme", values="mean")
    cells = pd.MultiIndex.from_frame(best[[*keys, "criterion"]])
    values = means.reindex(index=cells, columns=list(asked.contenders)).to_numpy(float)
    criteria = [asked.criteria[name] for name in best["criterion"]]
    squares = np.array([[each.values == "square"] for each in criteria])
    floor = np.array([[each.floor] for each in criteria])
    errors = np.where(squares, np.sqrt(np.maximum(values, 0.0)), values)
    least = np.where(np.isfinite(errors), errors, np.inf).min(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):  # no error is known, or none is left
        within = errors <= least + np.maximum(asked.margin * least, floor)
        tied = (within & (np.round(errors / least, 9) > 1.0)).any(axis=1)
    known, simplest = within.any(axis=1), within.argmax(axis=1)
    names = np.array(asked.contenders, dtype=object)
    table = best.assign(left=[SEPARATOR.join(names[chosen]) for chosen in within])
    table["verdict"] = np.where(tied, "tie", np.where(known, "won", table["verdict"]))
    table["distinguishable"] = table["verdict"] == "won"
    moved = known & (names[simplest] != table["best"])
    for column, value in (
        ("runner_up", table["best"].where(tied, table["runner_up"])),
        ("error_runner_up", table["error_best"].where(tied, table["error_runner_up"])),
        ("error_best", errors[np.arange(len(errors)), simplest]),
        ("best", names[simplest]),
    ):
        table.loc[moved, column] = value[moved]
    return table
