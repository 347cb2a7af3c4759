"""Tells a best-scheme map in sentences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def tell_winners(cells: pd.DataFrame) -> str:
    """Return in one sentence which schemes, and which baselines, win in how many cells.

    Parameters
    ----------
    cells
        Rows of best_scheme.csv with one criterion and one window: one row per cell. A baseline wins
        where the column `baseline_wins`, which a run without baselines lacks, is true.
    """
    wins = cells["baseline_wins"].astype(bool) if "baseline_wins" in cells else cells.index < 0
    won, others = cells[wins], cells[~wins]
    beaten = ", ".join(f"{name} in {n}" for name, n in _count(won["baseline"])) if len(won) else ""
    if others.empty:
        return f"A baseline beats every scheme in all {len(cells)} cells ({beaten})."
    (first, n), *more = _count(others["best"])
    sentence = f"{first} is best in {n} of {len(cells)} cells"
    sentence += "".join(f", {name} in {n}" for name, n in more)
    if beaten:
        sentence += f"; in {len(won)} a baseline beats every scheme ({beaten})"
    ties = int((~others["distinguishable"].astype(bool)).sum())
    if ties:
        sentence += f"; in {ties} the next best cannot be told apart from the best"
    return f"{sentence}."


def tell_beaten(
    name: str, cells: pd.DataFrame, summary: pd.DataFrame, conditions: Sequence[str], unit: str
) -> str:
    """Return in one sentence what error a scheme has that is best in no cell.

    Parameters
    ----------
    name
        The scheme.
    cells
        Rows of best_scheme.csv with one criterion and one window: one row per cell.
    summary
        The run's table summary.csv.
    conditions
        The names of the conditions.
    unit
        The unit of the criterion's MSE.
    """
    keys = [*conditions, "window"]
    own = summary[(summary["scheme"] == name) & (summary["measure"] == cells["criterion"].iloc[0])]
    both = cells[[*keys, "mse_best"]].merge(own, on=keys)
    if both.empty:
        return f"{name} is best in no cell: it has no result."
    error, ratio = both["mean"], both["mean"] / both["mse_best"]
    most = f"{ratio.max():.3g}" if ratio.max() < 1e3 else f"{ratio.max():.0f}"
    return (
        f"{name} is best in no cell: its MSE is {error.min():.3g} to {error.max():.3g} {unit}, "
        f"{ratio.min():.3g} to {most} times the least one."
    )


def _count(names: pd.Series[str]) -> list[tuple[str, int]]:
    """Return each name and how often it occurs, the most frequent first."""
    counts = names.value_counts(sort=False).sort_values(ascending=False, kind="stable")
    return [(str(name), int(n)) for name, n in counts.items()]
