"""The legend's entry of a scheme on a map whose fill shows the margin: a strip of shades."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.legend_handler import HandlerBase
from matplotlib.patches import Patch, Rectangle
from matplotlib.transforms import Transform

from owtsweep.figures.margin import PALEST, explain
from owtsweep.figures.palette import mix_with_white
from owtsweep.figures.plane import Row

#: A map of more schemes lists those in the legend that are best somewhere, the others below.
MOST_LISTED = 9
#: Number of shades in the strip.
COUNT = 4


class Shades(Patch):
    """The handle of a scheme's entry; its face has the scheme's full colour."""


class _Strip(HandlerBase):
    """Draws a `Shades` as rectangles side by side, the palest shade on the left."""

    def create_artists(
        self,
        legend: Legend,
        orig_handle: Artist,
        xdescent: float,
        ydescent: float,
        width: float,
        height: float,
        fontsize: float,
        trans: Transform,
    ) -> list[Rectangle]:
        from matplotlib.colors import to_hex

        assert isinstance(orig_handle, Shades)
        color, step = to_hex(orig_handle.get_facecolor()), width / COUNT
        return [
            Rectangle(
                (number * step - xdescent, -ydescent), step, height, linewidth=0.0,
                facecolor=mix_with_white(color, share), transform=trans,
            )
            for number, share in enumerate(np.linspace(PALEST, 1.0, COUNT))
        ]  # fmt: skip


#: For the argument `handler_map` of `Figure.legend`.
HANDLERS: dict[type[Artist], HandlerBase] = {Shades: _Strip()}


def add_legend(figure: Figure, handles: Sequence[Artist], columns: int, score: str = "MSE") -> None:
    """Put the legend of a map above its title; the legend's own title explains the shades.

    `score` is what schemes are judged by.
    """
    figure.legend(
        handles=handles, handler_map=HANDLERS, ncols=columns, loc="outside upper center",
        frameon=False, title=explain(score), title_fontsize=9,
    )  # fmt: skip


def list_in_legend(rows: Sequence[Row], schemes: Sequence[str]) -> list[str]:
    """Return the schemes that a map's legend lists: all, or of many those that are best somewhere.

    `rows` are the cells, rows of best_scheme.csv.
    """
    if len(schemes) <= MOST_LISTED:
        return list(schemes)
    winners = {row["best"] for row in rows}
    return [name for name in schemes if name in winners]
