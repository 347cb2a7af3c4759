"""Tells a best-scheme map in one sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def tell_winners(cells: pd.DataFrame) -> str:
    """Return in one sentence which schemes are best in how many cells.

    Parameters
    ----------
    cells
        Rows of best_scheme.csv with one criterion and one window: one row per cell.
    """
    counts = cells["best"].value_counts(sort=False).sort_values(ascending=False, kind="stable")
    total = len(cells)
    first, *others = [f"{name} is best in {n}" for name, n in counts.items()]
    more = [told.replace(" is best in ", " in ") for told in others]
    sentence = f"{first} of {total} cells" + "".join(f", {told}" for told in more)
    ties = int((~cells["distinguishable"].astype(bool)).sum())
    if ties:
        sentence += f"; in {ties} the next best cannot be told apart from the best"
    return f"{sentence}."
