"""Writes the errors over the values of a key as table and figure, and tells them on a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import save_figure
from owtsweep.io.tables import write_table
from owtsweep.results.conditions import show_value
from owtsweep.studies.hub.varying.errors import Errors
from owtsweep.studies.hub.varying.sentences import (
    answer_each,
    describe_error,
    describe_motion,
    find_best,
    list_names,
)

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table


@dataclass(frozen=True)
class VariedErrors:
    """The errors over the values of a key, an `owtsweep.sweep.study.Varied`."""

    errors: Errors

    def write(self, folder: Path, metadata: Mapping[str, str]) -> list[Path]:
        """Write vary.csv, vary.png and vary.svg into `folder`; return their paths."""
        from owtsweep.studies.hub.varying import drawing

        files = save_figure(partial(drawing.draw, self.errors), metadata)(folder, "vary")
        return [*files, write_table(folder, "vary", self.errors.table())]

    def answer(self) -> RenderableType:
        from rich.console import Group
        from rich.text import Text

        tables = [self._make_table(number) for number in range(len(self.errors.motions))]
        facts = f"At all values: {'; '.join(self.errors.facts)}"
        sentences = [*answer_each(self.errors), " ".join(self.errors.notes)]
        return Group(Text(facts), *tables, *(Text(sentence) for sentence in sentences))

    def _make_table(self, number: int) -> Table:
        from rich import box
        from rich.table import Table
        from rich.text import Text

        errors, best = self.errors, find_best(self.errors, self.errors.names)[number]
        table = Table(
            title=Text(
                f"Settled {describe_error(errors)} over {errors.along.title}; "
                f"{describe_motion(*errors.motions[number])}"
            ),
            box=box.SIMPLE, title_style="bold", title_justify="left", header_style="",
            padding=(0, 1, 0, 0),
        )  # fmt: skip
        # Numbers are never cut: ten columns of them fit into 80 characters.
        table.add_column(Text(errors.along.unit or "value"), justify="right", overflow="fold")
        for column in (*errors.names, "bound"):
            table.add_column(Text(column), justify="right", no_wrap=True)
        table.add_column("best")
        rms, bound = errors.rms()[:, :, number], errors.rms_of_bound()
        for n, value in enumerate(errors.values):
            cells = [f"{error:.3g}" for error in (*rms[:, n], bound[n])]
            table.add_row(Text(show_value(value)), *cells, Text(list_names(best[n])))
        return table
