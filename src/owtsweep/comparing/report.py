"""Write the text of a comparison: overview for the terminal, sections of a report, origins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from owtsweep.comparing.common import Judged
from owtsweep.comparing.comparison import Aspects
from owtsweep.io import markdown
from owtsweep.results.conditions import Condition, show_value

#: Greatest number of different values of one setting that are listed.
MOST_VALUES = 4


def make_overview(runs: Sequence[Judged], shared: Aspects, changed: pd.DataFrame) -> pd.DataFrame:
    """Make the table of a comparison for the terminal: one row per run, with texts as entries.

    The columns are: for each scheme, the number of cells in which it is best; in how many cells the
    best scheme is surely better than the next one; the range of the boundary between two schemes,
    if the study has one; and the number of cells with another best scheme than in the first run.
    `changed` is the table changed_cells.csv: for each pair of runs, one row per cell in which the
    best scheme differs.
    """
    rows = []
    for index, judged in enumerate(runs):
        wins = judged.best["best"]
        row = {f"cells {name}": str(int((wins == name).sum())) for name in shared.schemes}
        row["won"] = f"{int(judged.best['distinguishable'].sum())} of {len(wins)}"
        if shared.boundary is not None:
            row["boundary"] = _tell_range(judged.boundaries, shared)
        ends = changed["from_run"] == runs[0].run.label, changed["to_run"] == judged.run.label
        mine = changed[ends[0] & ends[1]]
        established = int(mine["established"].sum())
        row["cells changed"] = "-" if index == 0 else f"{len(mine)} ({established} established)"
        rows.append(row)
    return pd.DataFrame(rows)


def _tell_range(boundaries: pd.DataFrame | None, shared: Aspects) -> str:
    if boundaries is None or boundaries.empty:
        return "not known"
    exists = boundaries[boundaries["wins"] == ""]
    if exists.empty:
        winners = sorted(set(boundaries["wins"]))
        return f"none ({winners[0]} better)" if len(winners) == 1 else "none"
    low, high = exists["boundary"].min(), exists["boundary"].max()
    *outer, expanded = shared.conditions
    span = f"{low:.2g}" if len(exists) == 1 else f"{low:.2g}-{high:.2g}"
    span = f"{span} {expanded.unit}".rstrip()
    where = " x ".join(condition.values_word for condition in outer)
    return f"{span} at {len(exists)}/{len(boundaries)} {where}" if outer else span


def write_sections(shared: Aspects, tables: Mapping[str, pd.DataFrame]) -> str:
    """Return the sections of a comparison's report, in Markdown.

    They explain the columns of the overview, say which cells changed their best scheme and how the
    boundary moved, and list the files.
    """
    files = [
        "- `runs.csv`: run folders, hashes, swept values",
        "- `best_schemes.csv`: the maps, as each run's best_scheme.csv, on the common cells",
        "- `changed_cells.csv`: gaps between old and new best scheme in both runs, and their "
        "change, with 95 % intervals",
        f"- `scheme_changes.csv`: per scheme and cell the difference and ratio of {shared.score}",
    ]
    boundary = []
    if shared.boundary is not None:
        shifts = _tell_shifts(tables["boundary_shifts"], shared.conditions[:-1])
        boundary = ["## Boundary against the other run", shifts]
        files.append(
            "- `boundaries.csv`, `boundary_shifts.csv`: the boundary per run; its ratio per pair"
        )
    return "\n\n".join(
        [
            "## What the columns say",
            f"Compared are {shared.size} cells by {shared.criterion} {shared.score}: "
            "how many a scheme is best in, how many are *won* (the best one is told from the next, "
            "as `distinguishable` in best_schemes.csv says), and in how many the best scheme is "
            "another one than in the first run. A change is *established* if the old best scheme "
            "beats the new one in the first run, and loses to it in the second, both told from "
            "zero (the larger p-value, Holm's correction over all cells).",
            "## Cells that change their best scheme",
            _tell_changes(tables["changed_cells"]),
            *boundary,
            "## Files",
            "\n".join(files),
        ]
    )


def _tell_changes(changed: pd.DataFrame) -> str:
    if changed.empty:
        return "None."
    rows = []
    for (one, other), cells in changed.groupby(["from_run", "to_run"], sort=False):
        moves = (cells["best_from"] + " -> " + cells["best_to"]).value_counts(sort=False)
        text = ", ".join(f"{move}: {count}" for move, count in moves.items())
        established = str(int(cells["established"].sum()))
        rows.append([str(one), str(other), str(len(cells)), established, text])
    return markdown.table(["from", "to", "cells", "established", "from -> to"], rows)


def _tell_shifts(moved: pd.DataFrame, outer: Sequence[Condition]) -> str:
    if moved.empty:
        place = " and ".join(condition.label for condition in outer) or "cell"
        return f"No {place} has a boundary in both runs of a pair."
    header = ["from", "to", *(condition.title for condition in outer), "ratio", "95 % interval"]
    rows = []
    for row in moved.to_dict("records"):
        cell = [show_value(row[condition.name]) for condition in outer]
        low, high = row["ratio_low"], row["ratio_high"]
        # an end is NaN if the two schemes did not cross in some draws
        interval = f"{low:.3g} to {high:.3g}" if low <= high else "not known"
        rows.append([row["from_run"], row["to_run"], *cell, f"{row['ratio']:.3g}", interval])
    return markdown.table(header, rows)


def describe_origins(aspects: Sequence[Aspects]) -> str:
    """Return sentences on the tuning, truth, seed and number of records of compared runs.

    One lists the settings that have one value in all runs, another those that differ. The text is
    empty if the study does not say where its numbers come from.
    """
    common, different = [], []
    for name in dict.fromkeys(name for own in aspects for name in own.origin):
        values = list(dict.fromkeys(own.origin.get(name, "none") for own in aspects))
        if len(values) == 1:
            common.append(f"{name} {values[0]}")
            continue
        shown = [*values[:MOST_VALUES], "..."] if len(values) > MOST_VALUES else values
        different.append(f"{name} ({', '.join(shown)})")
    in_all = [f"In all runs: {', '.join(common)}."] if common else []
    in_some = [f"The runs differ in {', '.join(different)}."] if different else []
    return " ".join(in_all + in_some)
