"""Write the files of a report on published results: tables, figures, Markdown and HTML pages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import save_figure
from owtsweep.io.files import write_atomically
from owtsweep.io.steps import tell_step
from owtsweep.io.tables import write_table
from owtsweep.verdicts.page import Block, to_html, to_markdown

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


def write_report(
    folder: Path,
    *,
    title: str,
    tables: Mapping[str, pd.DataFrame],
    figures: Mapping[str, Callable[[], Figure]],
    contents: Callable[[Mapping[str, Path]], Sequence[Block]],
    metadata: Mapping[str, str],
) -> list[Path]:
    """Write all files of the report that compares a run with published results.

    Parameters
    ----------
    folder
        Where to write; made if it does not exist. The tables, fidelity.md and fidelity.html go
        into this folder, the figures into its subfolder `figures`.
    title
        Title of the HTML file.
    tables
        File name without suffix -> table.
    figures
        File name without suffix -> function that draws the figure.
    contents
        Function that makes the page's headings, paragraphs, tables and pictures. Its argument is a
        mapping from the name of a figure to the PNG file of this figure.
    metadata
        Name -> text to store inside each file of a figure.

    Returns
    -------
    list of Path
        All files written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = [write_table(folder, stem, table) for stem, table in tables.items()]
    pictures = {}
    for number, (stem, draw) in enumerate(figures.items(), 1):
        tell_step(f"figure {number} of {len(figures)}: {stem}")
        saved = save_figure(draw, metadata)(folder / "figures", stem)
        pictures[stem] = saved[0]
        files += saved
    blocks = contents(pictures)
    for path, text in {
        folder / "fidelity.md": to_markdown(blocks, folder),
        folder / "fidelity.html": to_html(blocks, title),
    }.items():
        write_atomically(path, text)
        files.append(path)
    return files
