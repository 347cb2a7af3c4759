"""Draw the figures of a run: either all figures for which the run has data, or one by name."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.io.terminal import tell_step

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save_figure"]

logger = logging.getLogger(__name__)

#: A function that draws into a folder under a name and returns the files.
Drawing = Callable[[Path, str], list[Path]]


def save_figure(
    draw: Callable[[], Figure],
    metadata: Mapping[str, str] | None,
    origin: str = "",
    letters: float = 11.0,
) -> Drawing:
    """Return a function that draws and saves a figure; its arguments are a folder and a name.

    `draw` is called in the package's style. The texts of `metadata`, by name, are stored in the
    files. `origin` is written above the figure, its lines folded at so many `letters` per inch.
    """

    def drawing(folder: Path, name: str) -> list[Path]:
        from owtsweep.figures import style

        with style.context():
            figure = draw()
            if origin:
                style.add_origin(figure, origin, letters)
            return style.save(figure, folder, name, metadata)

    return drawing


def draw_each(
    drawings: Mapping[str, Drawing],
    folder: Path,
    only: str | None,
    guard: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> list[Path]:
    """Draw the figures of a run, and return the files.

    Raise `InputError` if there is no figure called `only`, or the run lacks the data for this
    figure.

    drawings: Name of a figure -> function that draws and saves the figure, or raises `InputError`
        if the run lacks the data.
    only: Name of the only figure to draw. None means all figures; those for which the run lacks
        data are then left out with a warning.
    guard: Makes the context in which each figure is drawn; it may turn errors into `InputError`.
    """
    if only is not None and only not in drawings:
        raise InputError(f"only: this run has no figure {only!r}; use {', '.join(drawings)}")
    files: list[Path] = []
    chosen = [name for name in drawings if only in (None, name)]
    for number, name in enumerate(chosen, 1):
        tell_step(f"figure {number} of {len(chosen)}: {name}")
        try:
            with guard():
                files += drawings[name](folder, name)
        except InputError as error:
            if only is not None:
                raise
            logger.warning("%s is left out: %s", name, error)
    return files
