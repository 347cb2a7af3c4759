"""What is made of a contest's rows: summary, best schemes, comparisons of runs."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import spread
from owtsweep.results.cube import Cube
from owtsweep.results.ratios import compare_with_best
from owtsweep.results.summary import summarise
from owtsweep.results.verdicts import Asked, count_cells, make_table
from owtsweep.studies.base.contest import WAIT, WINDOW, C, Contest, list_origin
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.studies.base.schemes import list_names


def make_tables(
    contest: Contest[C], config: C, rows: pd.DataFrame, contenders: Sequence[str]
) -> dict[str, pd.DataFrame]:
    """Make the tables "summary", "best_scheme" and "ratios" from a run's rows.

    contenders: Names of schemes, the simplest first.
    """
    rows = spread(rows, contest.get_grid(config))  # once, for all that follows
    summary = summarise(make_cube(contest, config, rows, list_names(config.schemes)))
    cube = make_cube(contest, config, rows)
    if config.grid.decides:
        best = make_table(cube, rows, ask(contest, config, contenders))
    else:
        measured = {name: each for name, each in contest.criteria.items() if name in cube.measures}
        best = find_best_schemes(cube, WINDOW, measured)
    ratios = compare_with_best(cube, best, contest.criteria)
    return {"summary": summary, "best_scheme": best, "ratios": ratios}


def ask(contest: Contest[C], config: C, contenders: Sequence[str]) -> Asked:
    """Return what a configuration asks of its map, with the criterion that decides first."""
    grid, first = config.grid, config.criterion
    return Asked(
        {first: contest.criteria[first], **contest.criteria},
        WINDOW,
        contenders,
        (),
        count_cells(contest.get_grid(config)),
        grid.margin,
        grid.most,
        contest.ties_from,
    )


def make_cube(
    contest: Contest[C], config: C, rows: pd.DataFrame, schemes: Sequence[str] | None = None
) -> Cube:
    """Arrange the rows of schemes as arrays over the axes of the map, measures and replicates.

    Without `schemes`, these are the ones that compete.
    """
    return Cube.of_rows(
        spread(rows, contest.get_grid(config)),
        list_competing(config, rows) if schemes is None else schemes,
        contest.find_conditions(config),
        contest.get_grid(config),
        measures=contest.measures,
    )


def find_latencies(rows: pd.DataFrame) -> dict[str, float]:
    """Return the schemes with a latency, each with its latency, s."""
    waiting = rows[rows["measure"] == WAIT].groupby("scheme", observed=True)["value"]
    return {str(name): float(latency) for name, latency in waiting.max().items()}


def list_competing(config: ContestConfig, rows: pd.DataFrame) -> list[str]:
    """Return the schemes without a latency; all of them if every one has one.

    `rows` are a run's rows, or its table summary.csv: what has the columns measure and scheme.
    """
    waiting = {*rows.loc[rows["measure"] == WAIT, "scheme"]}
    names = list_names(config.schemes)
    return [name for name in names if name not in waiting] or names


def describe_run(contest: Contest[C], run: Candidate) -> Aspects:
    """Describe a run by its axes, schemes and criterion, and by what makes its records."""
    config = run.config
    return Aspects(
        conditions=contest.find_conditions(config),
        grid=contest.get_grid(config),
        schemes=list_competing(config, run.rows),
        criterion=config.criterion,
        window=WINDOW,
        pairing={key: getattr(config, key) for key in contest.pairing},
        origin=list_origin(contest, config),
        score="error",
    )
