"""Writes the page of a multirun: which scheme is best in how many cells of each run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from owtsweep.errors import InputError, printable
from owtsweep.io.files import write_atomically
from owtsweep.io.tables import read_table
from owtsweep.report.several_page import make_multirun_page
from owtsweep.results.answer import tell_counts
from owtsweep.sweep.asked import PAGE
from owtsweep.sweep.multirun_record import JobOutcome, PlannedRun


def write_page(folder: Path, planned: Sequence[PlannedRun], outcomes: Sequence[JobOutcome]) -> None:
    """Write report.html of a multirun, which links to the pages of its runs, into its folder.

    Raises OSError if the file system refuses the file.
    """
    values = {run.folder: run.values for run in planned}
    keys = list(dict.fromkeys(key for run in planned for key in run.values))
    rows, links = [], []
    for outcome in outcomes:
        given = values.get(outcome.folder, {})
        state = outcome.reason or "done"
        rows.append(
            [
                outcome.folder,
                *(given.get(key, "") for key in keys),
                *_tell_verdicts(folder / outcome.folder),
                state,
            ]
        )
        there = (folder / outcome.folder / PAGE).is_file()
        links.append(f"{outcome.folder}/{PAGE}" if there else "")
    header = ["run", *keys, "judged by", "best", "error of the best", "outcome"]
    title = f"{len(outcomes)} runs: {printable(folder.name)}"
    write_atomically(folder / PAGE, make_multirun_page(title, header, rows, links))


def _tell_verdicts(run: Path) -> list[str]:
    """Return by what a run is judged, who is best in how many cells, and the range of the error."""
    try:
        best = read_table(run, "best_scheme")
    except InputError:  # no case has succeeded, or the study makes no such table
        return ["", "", ""]
    if not len(best) or "error_best" not in best:
        return ["", "", ""]
    criterion = str(best["criterion"].iloc[0])
    shown = best[best["criterion"] == criterion]
    parts = shown.groupby("tuning", sort=False) if "tuning" in shown else [("", shown)]
    told = [f"{tuning}: {tell_counts(cells)}".removeprefix(": ") for tuning, cells in parts]
    low, high = shown["error_best"].min(), shown["error_best"].max()
    return [criterion, " ".join(told), f"{low:.3g} to {high:.3g}"]
