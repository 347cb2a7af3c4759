"""The words of a comparison: one line per run, and the sections of its report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from owtsweep.comparing.cells import Common
from owtsweep.io import markdown
from owtsweep.sweep.comparison import Candidate, Comparison

if TYPE_CHECKING:
    import pandas as pd


def overview(
    runs: Sequence[Candidate],
    shared: Common,
    best: Sequence[pd.DataFrame],
    boundaries: pd.DataFrame,
    changed: pd.DataFrame,
) -> pd.DataFrame:
    """Per run: cells won by each scheme, the boundary, cells changed against the first run."""
    import pandas as pd

    from owtsweep.comparing import label

    first = label(runs[0])
    rows = []
    for index, run in enumerate(runs):
        wins = best[index]["best"]
        row = {f"cells {name}": str(int((wins == name).sum())) for name in shared.schemes}
        row["boundary"] = _range(boundaries[boundaries["index"] == index])
        mine = changed[(changed["from_run"] == first) & (changed["to_run"] == label(run))]
        established = int(mine["established"].sum())
        row["cells changed"] = "-" if index == 0 else f"{len(mine)} ({established} established)"
        rows.append(row)
    return pd.DataFrame(rows)


def _range(found: pd.DataFrame) -> str:
    exists = found[found["wins"] == ""]
    if found.empty:
        return "not known"
    if exists.empty:
        winners = sorted(set(found["wins"]))
        return f"none ({winners[0]} better)" if len(winners) == 1 else "none"
    low, high = exists["boundary"].min(), exists["boundary"].max()
    span = f"{low:.2g} m" if len(exists) == 1 else f"{low:.2g}-{high:.2g} m"
    return f"{span} at {len(exists)}/{len(found)} periods"


def sections(comparison: Comparison, shared: Common, tables: Mapping[str, pd.DataFrame]) -> str:
    """What the tables hold, and their heads."""
    changed, moved = tables["changed_cells"], tables["boundary_shifts"]
    return "\n\n".join(
        [
            "## What the columns say",
            f"Compared are {len(shared.cells)} cells by {shared.criterion} MSE: "
            "how many a scheme is best in, and in how many the best scheme is another one than in "
            "the first run. A change is *established* if the old best scheme beats the new one in "
            "the first run, and loses to it in the second, both told from zero (the larger "
            "p-value, Holm's correction over all cells).",
            "## Cells that change their best scheme",
            _changes(changed),
            "## Boundary against the other run",
            _shifts(moved),
            "## Files",
            "- `runs.csv`: run folders, hashes, swept values\n"
            "- `best_schemes.csv`: the maps, as each run's best_scheme.csv, on the common cells\n"
            "- `changed_cells.csv`: gaps between old and new best scheme in both runs, and their "
            "change, with 95 % intervals\n"
            "- `scheme_changes.csv`: per scheme and cell the difference and ratio of MSE\n"
            "- `boundaries.csv`, `boundary_shifts.csv`: the boundary per run; its ratio per pair",
        ]
    )


def _changes(changed: pd.DataFrame) -> str:
    if changed.empty:
        return "None."
    rows = []
    for (one, other), own in changed.groupby(["from_run", "to_run"], sort=False):
        moves = (own["best_from"] + " -> " + own["best_to"]).value_counts(sort=False)
        told = ", ".join(f"{move}: {count}" for move, count in moves.items())
        rows.append([str(one), str(other), str(len(own)), str(int(own["established"].sum())), told])
    return markdown.table(["from", "to", "cells", "established", "from -> to"], rows)


def _shifts(moved: pd.DataFrame) -> str:
    if moved.empty:
        return "No natural period has a boundary in both runs of a pair."
    rows = [
        [
            row["from_run"],
            row["to_run"],
            f"{row['natural_period']:g}",
            f"{row['ratio']:.3g}",
            _interval(row["ratio_low"], row["ratio_high"]),
        ]
        for row in moved.to_dict("records")
    ]
    return markdown.table(["from", "to", "natural period (s)", "ratio", "95 % interval"], rows)


def _interval(low: float, high: float) -> str:
    """Ends that are not known are said so: in some draws the two schemes did not cross."""
    if low == low and high == high:
        return f"{low:.3g} to {high:.3g}"
    return "not known"
