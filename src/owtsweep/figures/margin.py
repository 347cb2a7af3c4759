"""Shade a scheme's colour by its margin: how many times as large the runner-up's error is.

A pale fill says that best and runner-up are nearly equally good; a full one, that the choice
matters.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from owtsweep.arrays import Array
from owtsweep.figures.palette import SchemeStyle, channels_of, mix_with_white, style_of
from owtsweep.figures.plane import Row
from owtsweep.figures.style import HANDLERS, Handle, label_of

#: The fill is the scheme's full colour where the runner-up's error is this many times the best
#: one's, or more.
FULL = 3.0
#: Share of the scheme's colour in the fill of a tie; the rest is white.
PALEST = 0.3


#: What a map's legend says about the shades.
EXPLANATION = (
    f"Pale: the runner-up's error is equal. Full colour: it is {FULL:g} times as large, or more."
)


def share_of_color(ratio: ArrayLike) -> Array:
    """Return the share of the scheme's colour in the fill, from `PALEST` to 1; the rest is white.

    It grows with the logarithm of `ratio`, the runner-up's error over the best one's, and is 1
    where there is no runner-up (NaN).
    """
    ratio = np.asarray(ratio, dtype=float)
    strength = np.log(np.clip(ratio, 1.0, FULL)) / np.log(FULL)
    return np.where(np.isnan(ratio), 1.0, PALEST + (1.0 - PALEST) * strength)


def ratio_of(row: Row) -> float:
    """Return the runner-up's error over the best one's in a row of best_scheme.csv.

    NaN without a runner-up, or if the least error is not positive.
    """
    best = float(row["error_best"])
    return float(row["error_runner_up"]) / best if best > 0.0 else float("nan")


def fill_cell(style: SchemeStyle, ratio: float) -> str:
    """Return the fill "#RRGGBB" of a cell; `ratio` is as in `share_of_color`."""
    return mix_with_white(style.color, float(share_of_color(ratio)))


def fill_regions(best: NDArray[np.intp], ratio: Array, colors: Sequence[str]) -> Array:
    """Return the fills of a fine map: red, green and blue from 0 to 1, shape (lines, columns, 3).

    `best` holds indices in `colors` ("#RRGGBB"), and `ratio` is as in `share_of_color`; both have
    the shape (columns, lines).
    """
    full = np.array([channels_of(color) for color in colors])[best.T]
    return np.asarray(1.0 - share_of_color(ratio).T[..., np.newaxis] * (1.0 - full))


#: A map of more schemes lists those in the legend that are best somewhere, the others below.
MOST_LISTED = 9
#: Number of shades in the strip.
COUNT = 4


class Shades(tuple[Patch, ...]):
    """A scheme's entry of a legend: patches side by side, the palest shade on the left."""

    label: str

    def get_label(self) -> str:
        return self.label


def make_entry(name: str, schemes: Sequence[str], label: str = "") -> Shades:
    """Return a scheme's entry of a legend, in its style among all `schemes`; `label` or `name`."""
    color = style_of(name, schemes).color
    fills = (mix_with_white(color, share) for share in np.linspace(PALEST, 1.0, COUNT))
    entry = Shades(Patch(facecolor=fill, linewidth=0.0) for fill in fills)
    entry.label = label_of(label or name)
    return entry


def list_shades(names: Sequence[str], schemes: Sequence[str]) -> list[Handle]:
    """Return the entries of a map's legend for `names`, in their styles among all `schemes`."""
    return [make_entry(name, schemes) for name in names]


def add_legend(figure: Figure, handles: Sequence[Handle], columns: int) -> None:
    """Put the legend of a map above its title; the legend's own title explains the shades."""
    figure.legend(
        handles=handles, handler_map=HANDLERS, ncols=columns, loc="outside upper center",
        frameon=False, title=EXPLANATION, title_fontsize=9,
    )  # fmt: skip


def list_in_legend(rows: Sequence[Row], schemes: Sequence[str]) -> list[str]:
    """Return the schemes of a map's legend: all or, if they are many, those best somewhere."""
    if len(schemes) <= MOST_LISTED:
        return list(schemes)
    winners = {row["best"] for row in rows}
    return [name for name in schemes if name in winners]
