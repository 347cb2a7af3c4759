"""Set the style of figures and save them; figures drawn alike are saved as equal bytes."""

from __future__ import annotations

import json
import re
import textwrap
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.text import Text

from owtsweep.io.files import write_all

RESOLUTION = 160  # dots per inch of PNG files
EMBEDDED_RESOLUTION = 100  # dots per inch of images inside SVG files
SVG_LIMIT = 500 * 1024  # bytes

RC: Any = {
    "font.family": "DejaVu Sans",  # part of matplotlib, so every machine draws the same
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.labelsize": 10,
    "legend.fontsize": 9,
    "axes.grid": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.linewidth": 1.0,
    "svg.hashsalt": "owtsweep",  # ids of an SVG are random without it
}
#: The TeX of our own labels. Any other TeX is somebody's name, and is drawn as it was typed.
OWN_TEX = re.compile(r"\$_[2xy]\$")
#: Has no width. Put before a label that begins with `_`, which matplotlib leaves out of legends.
JOINER = "\N{WORD JOINER}"
WINDOWS = {"full": "full record", "settled": "settled part of the record"}


@contextmanager
def context() -> Iterator[None]:
    """Set matplotlib to the package's settings inside a `with` block, then restore the user's."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(RC)
        yield


def new_figure(width: float, height: float) -> Figure:
    """Make an empty figure of a width and height in inches, outside pyplot, so no window opens."""
    return Figure(figsize=(width, height), layout="constrained")


def footnote(figure: Figure, text: str) -> None:
    """Write a paragraph below everything else, with lines broken to the width of the figure."""
    letters = int(13 * figure.get_figwidth())
    figure.supxlabel("\n".join(textwrap.wrap(text, letters)), x=0.01, ha="left", fontsize=8)


def label_of(name: str) -> str:
    """The label of a line that stands for somebody's name, so that it is in the legend."""
    return JOINER + name if name.startswith("_") else name


def add_legend_above(figure: Figure, handles: Sequence[Any], title: str, columns: int) -> None:
    """Put a legend above everything else; the legend's `title` serves as the figure's title."""
    figure.legend(
        handles=handles,
        title=title,
        title_fontsize=11,
        loc="outside upper left",
        alignment="left",
        ncols=columns,
        frameon=False,
    )


def explain_coinciding(groups: Sequence[Sequence[str]]) -> list[str]:
    """Write a sentence on each group of schemes that a map shows under the last of its names."""
    return [
        f"{' and '.join(group)} give the same numbers and are shown as {group[-1]}."
        for group in groups
    ]


def describe_window(window: str) -> str:
    """Describe a window in words, e.g. "full record"; an unknown window is named as it is."""
    return WINDOWS.get(window, window)


def save(
    figure: Figure, folder: Path, stem: str, metadata: Mapping[str, str] | None = None
) -> list[Path]:
    """Write `<stem>.png` and `<stem>.svg` into `folder`.

    Parameters
    ----------
    figure
        Drawn under `context`.
    folder
        Made if it does not exist.
    stem
        File name without suffix.
    metadata
        What to store inside both files, e.g. the run's hash: text chunks of the PNG, the
        description (as JSON) of the SVG. No date is stored.

    Returns
    -------
    list of Path
        The PNG and the SVG.

    Raises
    ------
    OSError
        If the file system refuses; older files stay as they were.
    """
    notes = dict(metadata or {})
    folder.mkdir(parents=True, exist_ok=True)
    png, svg = folder / f"{stem}.png", folder / f"{stem}.svg"
    described = {"Date": None, "Description": json.dumps(notes, sort_keys=True)}
    _draw_names_as_typed(figure)
    with context(), warnings.catch_warnings():
        # of a letter that the font lacks, or a name as long as the figure: both are drawn
        warnings.simplefilter("ignore", UserWarning)
        raster = _render_png(figure, notes)
        vector = _render_svg(figure, described)
        if len(vector) > SVG_LIMIT:
            # letters as text instead of outlines: smaller, but in the viewer's font
            with mpl.rc_context({"svg.fonttype": "none"}):
                vector = _render_svg(figure, described)
    write_all({png: raster, svg: vector})
    return [png, svg]


def _draw_names_as_typed(figure: Figure) -> None:
    # The numbers of logarithmic axes are TeX too; their texts are made later, while it is drawn.
    for text in figure.findobj(Text):
        if isinstance(text, Text) and "$" in OWN_TEX.sub("", text.get_text()):
            text.set_parse_math(False)


def _render_png(figure: Figure, notes: Mapping[str, str]) -> bytes:
    # `Figure.savefig` draws each figure twice, the first time only to lay it out. The canvas lays
    # the figure out while it draws.
    buffer = BytesIO()
    figure.dpi = RESOLUTION
    canvas: Any = FigureCanvasAgg(figure)  # matplotlib gives the method no types
    canvas.print_png(buffer, metadata=dict(notes))
    return buffer.getvalue()


def _render_svg(figure: Figure, notes: Mapping[str, str | None]) -> bytes:
    buffer = BytesIO()
    figure.dpi = EMBEDDED_RESOLUTION
    canvas: Any = FigureCanvasSVG(figure)
    canvas.print_svg(buffer, metadata=dict(notes))
    return buffer.getvalue()
