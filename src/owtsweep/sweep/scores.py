"""Makes the table of scores of a run, by which claims are judged."""

from __future__ import annotations

from owtsweep.errors import require
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import OK, blame
from owtsweep.verdicts.score_table import ScoreTable


def collect_scores(run: Run) -> ScoreTable:
    """Return the scores of a run of one tuning, over the part of each record that it judges by.

    Raises InputError if the run holds expected values instead of records, no case of it has
        succeeded, or its study makes no scores of schemes.
    """
    require(
        run.engine.samples,
        f"{run.folder}: this run has no records, so its results have no intervals; "
        "name a run with engine=batch",
    )
    rows = run.cases()
    require(
        bool((rows["status"] == OK).any()),
        f"{run.folder}: no case of this run has succeeded; run its sweep again",
    )
    with blame(run.study):
        conditions = run.study.conditions(run.config)
    names = {"scheme", "measure", "window", "replicate", "value", *(c.name for c in conditions)}
    require(
        names <= set(rows.columns),
        f"{run.folder}: the rows of study {run.study.name!r} are no scores of schemes",
    )
    windows, grid = list(rows["window"].unique()), {}
    last = conditions[-1]
    if len(windows) > 1 or last.expands:  # not all is in the rows; the run's tables have the rest
        with blame(run.study):
            tables = run.engine.tables(run.config, rows)
        windows = list(tables["best_scheme"]["window"].unique())
        grid[last.name] = list(tables["summary"][last.name].dropna().unique())
    return ScoreTable.of_rows(rows, conditions, grid, str(windows[0]))
