"""Makes the pages on several runs: those of a multirun, and those of a comparison."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from urllib.parse import quote

import pandas as pd

from owtsweep.report.document import clean, frame_table, make_page, make_picture
from owtsweep.report.run_page import scroll, tabulate, write_section


def make_multirun_page(
    title: str, header: Sequence[str], rows: Sequence[Sequence[str]], links: Sequence[str]
) -> str:
    """Return the page of a multirun as HTML: a line per run, with a link to the page of the run.

    header: headings of the columns.
    rows: the texts of each run's line; the first one becomes the link.
    links: Paths from the page to those of the runs; "" for a run without a page.
    """
    lines = []
    for row, link in zip(rows, links, strict=True):
        first, *others = (clean(text) for text in row)
        named = f'<a href="{quote(link)}">{first}</a>' if link else first
        cells = "".join(f"<td>{text}</td>" for text in others)
        lines.append(f'<th scope="row">{named}</th>{cells}')
    table = frame_table("", header, lines)
    note = "Each run is decided for itself: at 95 % over its own map, not over all maps together."
    section = write_section("Which is best in how many cells", scroll("Runs", table))
    return make_page(title, [section, f'<p class="note">{note}</p>'])


def make_comparison_page(
    title: str,
    origin: str,
    overview: pd.DataFrame,
    notes: Sequence[str],
    pictures: Mapping[str, bytes],
    tables: Mapping[str, pd.DataFrame],
) -> str:
    """Return the page of a comparison as HTML.

    origin: Where the numbers of all runs come from, in a line.
    overview: a line per run.
    pictures: Description -> PNG.
    tables: Name -> table; long ones are cut.
    """
    shown = [f'<p class="note">{clean(note)}</p>' for note in notes]
    parts = [
        f'<p class="origin">{clean(origin)}</p>',
        write_section(
            "Runs", scroll("Runs", tabulate("A line per run", overview)) + "".join(shown)
        ),
    ]
    if pictures:
        drawn = "".join(make_picture(png, text) for text, png in pictures.items())
        parts.append(write_section("How the map moves", drawn))
    parts += [
        write_section(f"Table {name}.csv", scroll(name, tabulate(f"{name}.csv", table)))
        for name, table in tables.items()
        if len(table)
    ]
    return make_page(title, parts)
