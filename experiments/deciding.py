"""How often a map that is decided look by look is wrong, and what it costs: simulated maps.

    python -m experiments.deciding [FOLDER] [MAPS] [RUN ...]

Writes deciding.csv into FOLDER (default: results/deciding). Each line is one kind of records, for
which MAPS maps (default 2000) of 60 cells each are decided by `statistics.deciding`:

- own: records of the folders RUN, made before (128 or more per cell), drawn with replacement. The
  truth of a cell is the mean of its records;
- lognormal: errors of four schemes, of which the better ones differ by some per cent, times
  lognormal factors; `sd` is the standard deviation of the difference over the error;
- skewed: the same with gamma factors whose differences have a skewness of about 6, and one record
  in a hundred in which a scheme has three times its error.

Columns: false_wins, false_ties and worse are shares of maps with a cell that is won by a scheme
that is not the best, tied although the scheme to take is worse than the margin, and decided for a
scheme that is worse than the margin; won, tied and open are shares of cells; records is the mean
number of records of a contender; fixed_records is the number with which one look decides 90 % of
the cells (NaN: more than 4096), and saving is records over it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

import owtsweep
from experiments.command import show, write
from owtsweep.arrays import Array
from owtsweep.results.cube import Cube
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.statistics.deciding import LEVEL, Rule, follow_looks, take_look
from owtsweep.studies import get_study

CELLS, CONTENDERS, MOST = 60, 4, 256
#: Standard deviations of the difference of two errors, over the error.
SCATTERS = (0.1, 0.2, 0.35, 0.5, 0.7)
SEED = 20261126


class Cell(NamedTuple):
    """Values of a cell, (contenders, records), the simplest first, and their true means."""

    values: Array
    means: Array


#: Draws a cell with some records.
Draw = Callable[[np.random.Generator, int], Cell]


def draw_errors(random: np.random.Generator) -> Array:
    """Return the errors of a cell's contenders: some alike, some apart, in any order."""
    errors = np.exp(random.normal(0.0, 0.15, CONTENDERS))
    if random.random() < 0.3:
        errors[1] = errors[0]
    return random.permutation(errors / errors.min())


def draw_lognormal(random: np.random.Generator, records: int, sd: float) -> Cell:
    """Draw squares of errors that all sea states share, times a factor of each scheme."""
    errors, own = draw_errors(random), sd / np.sqrt(2.0)
    shared = random.normal(0.0, 0.4, records)
    each = random.normal(0.0, own, (CONTENDERS, records))
    factors = np.exp(2.0 * (shared + each) - 2.0 * (0.4**2 + own**2))
    return Cell(errors[:, None] ** 2 * factors, errors**2)


def draw_skewed(random: np.random.Generator, records: int) -> Cell:
    """Draw squares of errors with rare large values, and rare failures."""
    errors = draw_errors(random)
    shape = 4.0 / 6.0**2  # a gamma's skewness is 2 / sqrt(shape)
    factors = 1.0 + 0.3 * (random.gamma(shape, 1.0 / shape, (CONTENDERS, records)) - 1.0)
    failed = random.random((CONTENDERS, records)) < 0.01
    factors = np.where(failed, 9.0, 1.0) * factors / (0.99 + 9.0 * 0.01)
    return Cell(errors[:, None] ** 2 * factors, errors**2)


def read_cells(folder: Path) -> list[Array]:
    """Return the values of each cell of a run by its criterion, those that coincide left out."""
    run = owtsweep.load(folder)
    cube, criterion, window = make_cube(run)
    measure, window_at = cube.measures.index(criterion), cube.windows.index(window)
    cells = []
    for place in cube.outer_places():
        each = np.stack(
            [cube.values(i, place, [measure])[:, 0, window_at] for i in range(len(cube.schemes))]
        )
        for values in each.swapaxes(0, 1):
            values = values[np.isfinite(values).all(axis=1)]
            hidden = {
                name
                for group in group_coinciding(
                    [str(i) for i in range(len(values))],
                    lambda i, j, values=values: bool(agree(values[i], values[j]).all()),
                )
                for name in group[1:]
            }
            values = values[[i for i in range(len(values)) if str(i) not in hidden]]
            if len(values) > 1:
                cells.append(values)
    return cells


def make_cube(run: owtsweep.sweep.runs.Run) -> tuple[Cube, str, str]:
    """Return the values of a run's contenders, baselines included, its criterion and its window."""
    config = run.config
    if config.study == "hub":
        from owtsweep.studies.hub.describe import make_cube

        measures = config.measures
        cube = make_cube(config, run.cases(), baselines=True)
        return cube, measures.criterion, measures.window
    from owtsweep.studies.base import tables
    from owtsweep.studies.base.contest import WINDOW

    study = get_study(config.study)
    names = tables.list_competing(config, run.cases())
    return tables.make_cube(study.contest(), config, run.cases(), names), config.criterion, WINDOW


def resample(cells: list[Array]) -> Draw:
    """Return a function that draws records of one of some cells with replacement."""

    def draw(random: np.random.Generator, records: int) -> Cell:
        values = cells[random.integers(len(cells))]
        return Cell(values[:, random.integers(values.shape[1], size=records)], values.mean(axis=1))

    return draw


def simulate(draw: Draw, rule: Rule, maps: int) -> dict[str, float]:
    """Decide maps of cells; return the shares of wrong ones, and what they cost."""
    random = np.random.default_rng(SEED)
    wrong = {"false_wins": 0, "false_ties": 0, "worse": 0}
    verdicts = dict.fromkeys(("won", "tie", "open", "none"), 0)
    runs, contenders = 0, 0
    for _ in range(maps):
        seen = set()
        for _ in range(CELLS):
            values, means = draw(random, rule.most)
            looks = list(follow_looks(values, rule, CELLS))
            last = looks[-1]
            # a contender runs until the look at which it leaves, or to the end
            runs += sum(
                next((each.records for each in looks if i not in each.left), last.records)
                for i in range(len(values))
            )
            contenders += len(values)
            verdicts[last.verdict] += 1
            seen |= find_faults(last.verdict, means, last.best, rule)
        for name in seen:
            wrong[name] += 1
    cells = maps * CELLS
    fixed = find_fixed_design(draw, rule)
    return {
        "maps": maps,
        **{name: count / maps for name, count in wrong.items()},
        "won": verdicts["won"] / cells,
        "tied": verdicts["tie"] / cells,
        "open": verdicts["open"] / cells,
        "records": runs / contenders,
        "fixed_records": fixed,
        "saving": runs / contenders / fixed,
    }


def find_faults(verdict: str, means: Array, best: int, rule: Rule) -> set[str]:
    """Return in what ways a decision is wrong."""
    errors = np.sqrt(means) if rule.squared else means
    is_worse = bool(errors[best] > (1.0 + rule.margin) * errors.min() * (1.0 + 1e-9))
    faults = set()
    if verdict == "won" and means[best] > means.min() * (1.0 + 1e-9):
        faults.add("false_wins")
    if verdict == "tie" and is_worse:
        faults.add("false_ties")
    if verdict in ("won", "tie") and is_worse:
        faults.add("worse")
    return faults


def find_fixed_design(draw: Draw, rule: Rule, cells: int = 600) -> float:
    """Return with how many records one look decides 90 % of the cells; NaN if more than 4096."""
    random = np.random.default_rng(SEED + 1)
    drawn = [draw(random, 4096).values for _ in range(cells)]
    for records in np.unique(np.rint(8.0 * 2.0 ** np.arange(0.0, 9.01, 0.25))).astype(int):
        decided = [
            take_look(
                values[:, :records], tuple(range(len(values))), rule._replace(ties_from=0),
                LEVEL / CELLS / (len(values) - 1),
            ).verdict
            != "open"
            for values in drawn
        ]  # fmt: skip
        if np.mean(decided) >= 0.9:
            return float(records)
    return float("nan")


def list_kinds(runs: list[Path]) -> Iterator[tuple[str, float, Draw, bool]]:
    """Yield each kind of records: its name, its scatter, how it is drawn, and if it is squared."""
    for folder in runs:
        squared = owtsweep.load(folder).config.study == "hub"
        yield f"own: {folder.name}", float("nan"), resample(read_cells(folder)), squared
    for sd in SCATTERS:
        yield "lognormal", sd, lambda random, n, sd=sd: draw_lognormal(random, n, sd), True
    yield "skewed", float("nan"), draw_skewed, True


def main() -> None:
    """Simulate all kinds of records, and write the table."""
    words = sys.argv[1:]
    folder, maps = Path(words[0] if words else "results/deciding"), int((words[1:] or ["2000"])[0])
    rows = []
    for kind, sd, draw, squared in list_kinds([Path(word) for word in words[2:]]):
        rows.append({"kind": kind, "sd": sd, **simulate(draw, Rule(squared=squared), maps)})
        print(kind, sd, flush=True)
    table = pd.DataFrame(rows)
    write(folder, {"deciding": table})
    show(table)


if __name__ == "__main__":
    main()
