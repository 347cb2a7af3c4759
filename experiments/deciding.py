"""How often a map that is decided look by look is wrong, and what it costs: simulated maps.

    python -m experiments.deciding [FOLDER] [MAPS] [STUDY ...]

Writes deciding.csv into FOLDER (default: results/deciding). Each line is one kind of records, for
which MAPS maps (default 2000) of 60 cells each are decided by the rule of `statistics.deciding`:

- own: paired records of each STUDY (default: all five), drawn with replacement from the cells of a
  small map, baselines included. A sweep into FOLDER/records makes them first, once. The truth of a
  cell is the mean of its records;
- lognormal: errors of four schemes, of which the better ones differ by some per cent, times
  lognormal factors; `sd` is the standard deviation of the difference over the error;
- skewed: the same with gamma factors whose differences have a skewness of about 6, and one record
  in a hundred in which a scheme has three times its error.

Columns:

- false_wins, false_ties and worse are shares of maps with a cell that is won by a scheme that is
  not the best, tied although the scheme to take is worse than the margin, and decided for a scheme
  that is worse than the margin;
- won, tied and open are shares of cells; records is the mean number of records of a contender;
- fixed_records is the number with which one look at level .05 decides 90 % of the cells (NaN: more
  than 4096), fixed_alike that which decides as many as were decided; saving and saving_alike are
  records over these;
- bias is the mean relative error of the printed error of the scheme to take in a decided cell, and
  coverage the share of its nominal 95 % intervals that hold the truth; bias_fresh and
  coverage_fresh are those of as many records on which no decision rests.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import t

import owtsweep
from experiments.command import show, write
from owtsweep.arrays import Array
from owtsweep.results.conditions import spread
from owtsweep.results.cube import Cube
from owtsweep.results.verdicts import Asked, _find_run, list_cells
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.statistics.deciding import (
    ENOUGH,
    LEVEL,
    LOOKS,
    Rule,
    find_growth,
    find_level,
    is_below,
)
from owtsweep.sweep.runs import Run

CELLS, CONTENDERS, MOST = 60, 4, 256
#: Standard deviations of the difference of two errors, over the error.
SCATTERS = (0.1, 0.2, 0.35, 0.5, 0.7)
SEED = 20261126
#: The small map of each study whose records are drawn, without the schemes that are late, for these
#: compete nowhere, and without those that cannot work there. A record of the tower takes seconds,
#: so its records are shorter and fewer.
OWN = {
    "hub": ["grid=small", "measures.window=settled", "grid.replicates=128"],
    "floater": [
        "grid.delay=[0,8]", "grid.bias=[0,0.3]", "grid.replicates=128",
        "schemes=[KF_STEADY,KF,KF_CONSISTENT,KF_BIAS,KF_DELAY,KF_REPAIRED,PASSIVE_OBSERVER,"
        "COMPLEMENTARY,LOWPASS]",
    ],
    "blade": [
        "grid.sigma=[0.003,0.05]", "grid.outage=[20]", "grid.replicates=64",
        "schemes=[HOLD,GNSS_WAHBA,COMPLEMENTARY,UKF,MEKF,INVARIANT_EKF,MEKF_HEADING,MEKF_OFFSET,"
        "MEKF_LEVER,PENDULUM]",
    ],
    "mating": ["grid.sigma=[0.003,0.03]", "grid.outage=[20]", "grid.replicates=32"],
    "tower": [
        "grid.noise=[0.3,3]", "grid.soil_factor=[1]", "record.duration=150", "record.settling=50",
        "grid.replicates=24",
        "schemes=[AKF,AKF_MATERN12,AKF_MATERN32,GDF,AKF_WHOLE,KF_WHOLE,THRUST_LEVER,QUASI_STATIC]",
    ],
}  # fmt: skip
#: Most numbers that one comparison of all pairs takes at a time.
AT_A_TIME = 3_000_000
#: Most records of a fixed design.
LARGEST = 4096


class Cell(NamedTuple):
    """Values of a cell, (contenders, records), the simplest first, and their true means."""

    values: Array
    means: Array


#: Draws a cell with some records.
Draw = Callable[[np.random.Generator, int], Cell]


def _list_looks(most: int) -> list[int]:
    return [records for records in LOOKS if records <= most]


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


def make_records(study: str, folder: Path) -> Run:
    """Sweep over a small map of a study; a run that is in the folder already is only read."""
    words = [f"study={study}", f"name={study}", f"results={folder}", "tuning=matched"]
    return owtsweep.run([*words, *OWN[study]])


def read_cells(run: Run) -> tuple[list[Array], Rule]:
    """Return what is judged in each cell of a run by its criterion, and the rule of its study.

    The simplest contender is first. Of contenders that coincide, the simplest alone is there.
    """
    cube, rows, asked = read_map(run)
    name, criterion = next(iter(asked.criteria.items()))
    cells = []
    for cell in list_cells(cube, _find_run(cube, rows), asked, name):
        values = cell.values[np.isfinite(cell.values).all(axis=1)]
        groups = group_coinciding(
            [str(i) for i in range(len(values))],
            lambda i, j, values=values: bool(agree(values[i], values[j]).all()),
        )
        hidden = {int(name) for group in groups for name in group[1:]}
        values = values[[i for i in range(len(values)) if i not in hidden]]
        if len(values) > 1:
            cells.append(values)
    return cells, asked.make_rule(criterion)


def read_map(run: Run) -> tuple[Cube, pd.DataFrame, Asked]:
    """Return a run's contenders, baselines included: their values, rows, and what the map asks."""
    config, rows = run.config, run.cases()
    if config.study == "hub":
        from owtsweep.studies.hub.describe import ask, make_cube

        return make_cube(config, rows, baselines=True), rows, ask(config)
    from owtsweep.studies.base import tables

    contest, ranks = run.engine.contest, run.engine.rank(config)
    rows = spread(rows, contest.get_grid(config))
    cube = tables.make_cube(contest, config, rows, tables.list_competing(config, rows))
    return cube, rows, tables.ask(contest, config, ranks)


def resample(values: Array) -> Draw:
    """Return a function that draws records of a cell with replacement."""

    def draw(random: np.random.Generator, records: int) -> Cell:
        return Cell(values[:, random.integers(values.shape[1], size=records)], values.mean(axis=1))

    return draw


class Decided(NamedTuple):
    """What is known of some cells at the end, one number per cell.

    verdict: "won", "tie" or "open"; best: the contender to take. stop: Number of records seen.
    runs: Number of records of all contenders together: each runs until it leaves.
    """

    verdict: NDArray[np.str_]
    best: NDArray[np.int64]
    stop: NDArray[np.int64]
    runs: NDArray[np.int64]


def decide_all(values: Array, rule: Rule, cells: int) -> Decided:
    """Decide many cells, (cells, contenders, records), as `deciding.decide` does one of a map.

    Every number is finite. It is the same rule, for all cells at once (tests/statistics).
    """
    count, contenders, _ = values.shape
    left = np.ones((count, contenders), dtype=bool)
    runs = np.zeros(count, dtype=np.int64)
    found = Decided(np.full(count, "open"), np.zeros_like(runs), np.zeros_like(runs), runs)
    going, before = np.arange(count), 0
    for number, records in enumerate(_list_looks(rule.most), start=1):
        runs[going] += left[going].sum(axis=1) * (records - before)
        level, before = find_level(number) / cells / (contenders - 1), records
        seen = values[going, :, :records]
        left[going], verdict, found.best[going] = look_at(seen, left[going], rule, level)
        found.verdict[going], found.stop[going] = verdict, records
        going = going[verdict == "open"]
    return found


def look_at(
    seen: Array, left: NDArray[np.bool_], rule: Rule, level: float
) -> tuple[NDArray[np.bool_], NDArray[np.str_], NDArray[np.int64]]:
    """Take one look at many cells; return who is left, each cell's verdict and whom to take."""
    count, contenders, records = seen.shape
    size = max(1, AT_A_TIME // (contenders**2 * records))
    if count > size:
        parts = [
            look_at(seen[at : at + size], left[at : at + size], rule, level)
            for at in range(0, count, size)
        ]
        whole = [np.concatenate(each) for each in zip(*parts, strict=True)]
        return whole[0], whole[1], whole[2]
    factors = find_growth(seen.reshape(-1, records), rule).reshape(count, contenders)
    allowed = np.ones_like(factors) if records >= ENOUGH else factors
    better = is_below(seen[:, :, None] * allowed[:, :, None, None] - seen[:, None], level)
    left = left & ~(better & left[:, :, None]).any(axis=1)
    best = np.where(left, seen.mean(axis=2), np.inf).argmin(axis=1)
    verdict = np.where(left.sum(axis=1) == 1, "won", "open")
    if records >= rule.ties_from:
        simplest = left.argmax(axis=1)
        first = np.take_along_axis(seen, simplest[:, None, None], axis=1)
        near = is_below(first - seen * factors[:, :, None], level)
        near[np.arange(count), simplest] = True
        is_tie = (near | ~left).all(axis=1) & (verdict == "open")
        verdict, best = np.where(is_tie, "tie", verdict), np.where(is_tie, simplest, best)
    return left, verdict, best


def simulate(draws: Sequence[Draw], rule: Rule, maps: int) -> dict[str, float]:
    """Decide maps of cells, each of one of `draws`; return how many are wrong, and the cost."""
    random = np.random.default_rng(SEED)
    which = random.integers(len(draws), size=(maps, CELLS))
    wrong = {name: np.zeros((maps, CELLS), dtype=bool) for name in FAULTS}
    verdicts, runs, contenders = np.full((maps, CELLS), "open"), 0, 0
    printed: list[pd.DataFrame] = []
    for number, draw in enumerate(draws):
        places = np.argwhere(which == number)
        for part in np.array_split(places, max(1, len(places) // 500)):
            cells = [draw(random, 2 * rule.most) for _ in part]
            values, means = (np.stack(each) for each in zip(*cells, strict=True))
            found = decide_all(values, rule, CELLS)
            at = tuple(part.T)
            verdicts[at] = found.verdict
            runs, contenders = runs + int(found.runs.sum()), contenders + means.size
            for i, verdict in enumerate(found.verdict):
                for name in find_faults(verdict, means[i], int(found.best[i]), rule):
                    wrong[name][tuple(part[i])] = True
            printed.append(examine_printed(values, means, found, rule))
    decided = float(np.mean(verdicts != "open"))
    fixed = find_fixed_designs(draws, rule, (0.9, decided))
    return {
        "maps": maps,
        **{name: float(cells.any(axis=1).mean()) for name, cells in wrong.items()},
        **{key: float(np.mean(verdicts == name)) for key, name in SHARES.items()},
        "records": runs / contenders,
        "fixed_records": fixed[0],
        "saving": runs / contenders / fixed[0],
        "fixed_alike": fixed[1],
        "saving_alike": runs / contenders / fixed[1],
        **pd.concat(printed).mean().to_dict(),
    }


FAULTS = ("false_wins", "false_ties", "worse")
SHARES = {"won": "won", "tied": "tie", "open": "open"}


def find_faults(verdict: str, means: Array, best: int, rule: Rule) -> set[str]:
    """Return in what ways a decision is wrong."""
    errors = np.sqrt(means) if rule.squared else means
    allowed = max(rule.margin * errors.min(), rule.floor)
    is_worse = bool(errors[best] > (errors.min() + allowed) * (1.0 + 1e-9))
    faults = set()
    if verdict == "won" and means[best] > means.min() * (1.0 + 1e-9):
        faults.add("false_wins")
    if verdict == "tie" and is_worse:
        faults.add("false_ties")
    if verdict in ("won", "tie") and is_worse:
        faults.add("worse")
    return faults


def examine_printed(values: Array, means: Array, found: Decided, rule: Rule) -> pd.DataFrame:
    """Compare the printed error of the scheme to take in each decided cell with the truth.

    The first `rule.most` of the records, (cells, contenders, records), decided; the same number of
    later ones shows what the decision changes.
    """
    rows = []
    beyond = {n: t.ppf(0.975, n - 1) / np.sqrt(n) for n in _list_looks(rule.most)}
    for i in np.flatnonzero(found.verdict != "open"):
        n, of_best, truth = found.stop[i], values[i, found.best[i]], means[i, found.best[i]]
        row = {}
        for name, start in (("", 0), ("_fresh", rule.most)):
            seen = of_best[start : start + n]
            ratio = seen.mean() / truth
            half = beyond[int(n)] * seen.std(ddof=1)
            row[f"bias{name}"] = (np.sqrt(ratio) if rule.squared else ratio) - 1.0
            row[f"coverage{name}"] = float(abs(seen.mean() - truth) <= half)
        rows.append(row)
    return pd.DataFrame(rows)


def find_fixed_designs(
    draws: Sequence[Draw], rule: Rule, shares: Sequence[float], cells: int = 600
) -> list[float]:
    """Return with how many records one look decides some shares of the cells; NaN if too many."""
    random = np.random.default_rng(SEED + 1)
    drawn = {
        number: np.stack([draw(random, LARGEST).values for _ in range(cells // len(draws))])
        for number, draw in enumerate(draws)
    }
    found = np.full(len(shares), np.nan)
    for records in np.unique(np.rint(8.0 * 2.0 ** np.arange(0.0, 9.01, 0.25))).astype(int):
        decided = [
            look_at(
                values[:, :, :records], np.ones(values.shape[:2], dtype=bool),
                rule._replace(ties_from=0), LEVEL / CELLS / (values.shape[1] - 1),
            )[1] != "open"
            for values in drawn.values()
        ]  # fmt: skip
        reached = np.isnan(found) & (np.mean(np.concatenate(decided)) >= np.asarray(shares))
        found[reached] = records
        if not np.isnan(found).any():
            break
    return [float(each) for each in found]


def list_kinds(
    studies: Sequence[str], folder: Path
) -> Iterator[tuple[str, float, Sequence[Draw], Rule]]:
    """Yield each kind of records: its name, its scatter, how it is drawn, and the rule."""
    for study in studies:
        cells, rule = read_cells(make_records(study, folder))
        yield f"own: {study}", float("nan"), [resample(cell) for cell in cells], rule
    for sd in SCATTERS:
        yield "lognormal", sd, [lambda random, n, sd=sd: draw_lognormal(random, n, sd)], Rule()
    yield "skewed", float("nan"), [draw_skewed], Rule()


def main() -> None:
    """Simulate all kinds of records, and write the table."""
    words = sys.argv[1:]
    folder, maps = Path(words[0] if words else "results/deciding"), int((words[1:] or ["2000"])[0])
    rows = []
    for kind, sd, draws, rule in list_kinds(words[2:] or [*OWN], folder / "records"):
        rows.append({"kind": kind, "sd": sd, **simulate(draws, rule, maps)})
        print(kind, sd, flush=True)
    table = pd.DataFrame(rows)
    write(folder, {"deciding": table})
    show(table)


if __name__ == "__main__":
    main()
