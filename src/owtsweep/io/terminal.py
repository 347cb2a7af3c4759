"""What a terminal shows: the steps of a command that takes long, and tables.

One table has a title, another one goes on below where it does not fit.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderResult
    from rich.table import Table

_logger = logging.getLogger("owtsweep.steps")
#: Spaces between two columns; the last of them is the column line of rich's box.
GAP = 2


def tell_step(text: str) -> None:
    """Say what begins now, e.g. "figure 3 of 17: mse_3s"; unheard outside `show_steps`."""
    _logger.debug("%s", text)


@contextmanager
def show_steps() -> Iterator[None]:
    """Print each step on stderr while the context is open, if stderr is a terminal."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    console = Console(stderr=True)

    class Printing(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            console.print(record.getMessage(), markup=False, highlight=False)

    handler, level = Printing(), _logger.level
    _logger.addHandler(handler)
    _logger.setLevel(logging.DEBUG)
    try:
        yield
    finally:
        _logger.removeHandler(handler)
        _logger.setLevel(level)


def start_table(title: str, **more: Any) -> Table:
    """Return a table with a title and no column yet; the title is shown as typed."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    return Table(
        title=Text(title), title_style="bold", title_justify="left", box=box.SIMPLE,
        header_style="", **more,
    )  # fmt: skip


@dataclass(frozen=True)
class PartedTable:
    """A table that rich prints: in one part if it fits the terminal, else in parts below it.

    A heading is broken between words, a cell never; a single column that is wider than the terminal
    is folded. Each part begins with the first `repeated` columns. `title` and `caption` are a line
    above and a sentence below the table.
    """

    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    repeated: int = 1
    title: str = ""
    caption: str = ""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich import box
        from rich.table import Table
        from rich.text import Text

        widths = self._widths()
        if self.title:
            yield Text(self.title, style="bold")
        for part in break_columns(widths, options.max_width, repeated=self.repeated):
            table = Table(
                box=box.SIMPLE_HEAD, show_edge=False, padding=(0, GAP - 1, 0, 0), header_style=""
            )
            for column in part:
                justify: Literal["left", "right"] = "left" if column < self.repeated else "right"
                table.add_column(
                    Text(self.headings[column], justify=justify),
                    justify=justify, vertical="bottom", overflow="fold", width=widths[column],
                )  # fmt: skip
            for row in self.rows:
                table.add_row(*(Text(row[column]) for column in part))
            yield table
            yield Text()
        if self.caption:
            yield Text(self.caption)

    def _widths(self) -> list[int]:
        """Return the width of each column: of its longest cell or word of its heading."""
        from rich.cells import cell_len

        columns = zip(self.headings, *self.rows, strict=True)
        return [
            max(map(cell_len, (*heading.split(), *cells)), default=1) for heading, *cells in columns
        ]


def break_columns(
    widths: Sequence[int], room: int, *, repeated: int = 1, gap: int = GAP
) -> Iterator[list[int]]:
    """Yield the columns of each part of a table that fits into `room`, one column at least.

    Each part begins with the first `repeated` columns; `gap` spaces stand between two.
    """
    first = list(range(repeated))
    part = list(first)
    for column in range(repeated, len(widths)):
        taken = sum(widths[other] + gap for other in [*part, column]) - 1
        if taken > room and len(part) > repeated:
            yield part
            part = list(first)
        part.append(column)
    yield part
