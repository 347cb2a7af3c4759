"""Tells a best-scheme map in one sentence."""

from __future__ import annotations

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


def _count(names: pd.Series[str]) -> list[tuple[str, int]]:
    """Return each name and how often it occurs, the most frequent first."""
    counts = names.value_counts(sort=False).sort_values(ascending=False, kind="stable")
    return [(str(name), int(n)) for name, n in counts.items()]
