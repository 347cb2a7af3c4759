"""Set the style of figures, and save figures so that equal figures give equal bytes."""

from __future__ import annotations

import json
import re
import textwrap
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.text import Text
from matplotlib.typing import RcKeyType

from owtsweep.io.files import write_all

__all__ = ["context", "new_figure", "save"]

RESOLUTION = 160  # dots per inch of PNG files
EMBEDDED_RESOLUTION = 100  # dots per inch of images inside SVG files
SVG_LIMIT = 500 * 1024  # bytes
#: Heights of a line of text, inches: of the footnote, and of the origin above a map's legend.
FOOTNOTE_LINE, ORIGIN_LINE = 0.135, 0.15

RC: dict[RcKeyType, object] = {
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
#: Properties of a line, a patch or a text for matplotlib; each has a type of its own.
Look = dict[str, Any]
#: An entry of a legend: one artist, or several side by side; and how matplotlib draws the latter.
Handle = Artist | tuple[Artist, ...]
HANDLERS = {tuple: HandlerTuple(ndivide=None, pad=0.0)}
WINDOWS = {"full": "full record", "settled": "settled part of the record"}


@contextmanager
def context() -> Iterator[None]:
    """Set matplotlib to this package's settings inside a `with` block."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(RC)
        yield


def new_figure(width: float, height: float) -> Figure:
    """Make an empty figure, in inches, without pyplot: no window opens."""
    return Figure(figsize=(width, height), layout="constrained")


def footnote(figure: Figure, text: str) -> float:
    """Write a paragraph at the bottom of a figure; return its height in inches."""
    letters = int(13 * figure.get_figwidth())
    lines = textwrap.wrap(text, letters)
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", fontsize=8)
    return FOOTNOTE_LINE * len(lines)


def add_origin(figure: Figure, text: str, letters: float | None = None) -> None:
    """Write lines above everything else: where the numbers of the figure come from.

    Lines are folded at so many `letters` per inch of the figure's width; None: at none.
    """
    if letters is not None:
        width = round(letters * figure.get_figwidth())
        text = "\n".join(textwrap.fill(line, width) for line in text.split("\n"))
    title = figure.get_suptitle()
    if title:
        figure.suptitle(f"{title}\n{text}", x=0.01, ha="left")
    elif figure.legends:  # at the top of a map; a title of the figure would lie on the legend
        legend = figure.legends[0]
        legend.set_title(f"{text}\n{legend.get_title().get_text()}")
        room = ORIGIN_LINE * len(text.splitlines())  # else the map would have to give it
        figure.set_figheight(figure.get_figheight() + room)
    else:
        figure.suptitle(text, x=0.01, ha="left", fontsize=9)


def label_of(name: str) -> str:
    """Return the label for what is called `name`, so that the legend shows it.

    matplotlib leaves labels that begin with "_" out of legends, so a character without width is put
    before them.
    """
    return JOINER + name if name.startswith("_") else name


def add_legend_above(
    figure: Figure,
    handles: Sequence[Handle],
    title: str,
    columns: int,
) -> None:
    """Put a legend with a title at the top of a figure; `title` serves as the figure's title."""
    figure.legend(
        handles=handles,
        handler_map=HANDLERS,
        title=title,
        title_fontsize=11,
        loc="outside upper left",
        alignment="left",
        ncols=columns,
        frameon=False,
    )


def choose_groups(groups: Sequence[Sequence[str]], named: Collection[str]) -> list[Sequence[str]]:
    """Return the groups of schemes with equal results whose last name is one of `named`."""
    return [group for group in groups if group[-1] in named]


def explain_coinciding(groups: Sequence[Sequence[str]]) -> list[str]:
    """Return a sentence about each group of schemes with equal results, for a map's footnote."""
    return [
        f"{' and '.join(group)} give the same numbers and are shown as {group[-1]}."
        for group in groups
    ]


def describe_window(window: str) -> str:
    """Return a window in words, e.g. "full record" for "full"; return an unknown name unchanged."""
    return WINDOWS.get(window, window)


def save(
    figure: Figure, folder: Path, stem: str, metadata: Mapping[str, str] | None = None
) -> list[Path]:
    """Write `<stem>.png` and `<stem>.svg` into `folder`, made if need be; return the files.

    The figure was drawn inside `with context():`. The texts of `metadata`, by name, are stored in
    both files, as text chunks of the PNG and as the description (in JSON) of the SVG. No date is
    stored. Raise `OSError` if a file cannot be written. Files of these names that existed before
    are not changed.
    """
    notes = {"Title": _find_title(figure), **(metadata or {})}
    folder.mkdir(parents=True, exist_ok=True)
    png, svg = folder / f"{stem}.png", folder / f"{stem}.svg"
    described = {"Date": None, "Description": json.dumps(metadata or {}, sort_keys=True)}
    _draw_names_as_typed(figure)
    with context(), warnings.catch_warnings():
        # of a letter that the font lacks, or a name as long as the figure: both are drawn
        warnings.simplefilter("ignore", UserWarning)
        raster = _render(figure, RESOLUTION, "png", notes)
        vector = _render(figure, EMBEDDED_RESOLUTION, "svg", described)
        if len(vector) > SVG_LIMIT:
            # letters as text instead of outlines: smaller, but in the viewer's font
            with mpl.rc_context({"svg.fonttype": "none"}):
                vector = _render(figure, EMBEDDED_RESOLUTION, "svg", described)
    write_all({png: raster, svg: vector})
    return [png, svg]


def _find_title(figure: Figure) -> str:
    """Return the figure's title, or that of its first axes, in one line."""
    titles = [figure.get_suptitle()]
    titles += [axes.get_title(loc) for axes in figure.axes for loc in ("left", "center")]
    return "; ".join(next((title for title in titles if title), "").splitlines())


def _draw_names_as_typed(figure: Figure) -> None:
    # The numbers of logarithmic axes are TeX too; their texts are made later, while it is drawn.
    for text in figure.findobj(Text):
        if isinstance(text, Text) and "$" in OWN_TEX.sub("", text.get_text()):
            text.set_parse_math(False)


def _render(figure: Figure, dpi: int, kind: str, notes: Mapping[str, str | None]) -> bytes:
    """Return a figure as "png" or "svg"."""
    # `Figure.savefig` draws each figure twice, the first time only to lay it out. The canvas lays
    # the figure out while it draws.
    buffer = BytesIO()
    figure.dpi = dpi
    canvas = FigureCanvasAgg(figure) if kind == "png" else FigureCanvasSVG(figure)
    getattr(canvas, f"print_{kind}")(buffer, metadata=dict(notes))
    return buffer.getvalue()
