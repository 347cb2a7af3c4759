"""How a sweep tells that it is alive."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as RichProgress
    from rich.progress import Task, TaskID


class Progress(Protocol):
    """What a sweep reports while it runs, always from the process and thread that started it."""

    def start(self, total_cases: int, reused: int) -> None:
        """The sweep begins; of its cases `reused` are there already."""
        ...

    def advance(self, cases: int) -> None:
        """So many further cases are over, done or failed."""
        ...

    def fail(self, label: str, reason: str) -> None:
        """A block has failed."""
        ...

    def stop(self) -> None:
        """The sweep is over, whichever way."""
        ...


class SilentProgress:
    """Says nothing."""

    def start(self, total_cases: int, reused: int) -> None:
        """Say nothing."""

    def advance(self, cases: int) -> None:
        """Say nothing."""

    def fail(self, label: str, reason: str) -> None:
        """Say nothing."""

    def stop(self) -> None:
        """Say nothing."""


class BarProgress:
    """A bar with the cases done, their rate and the time left; failures as lines above it."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._bar: RichProgress | None = None
        self._task: TaskID | None = None

    def start(self, total_cases: int, reused: int) -> None:
        """Show the bar; cases that are there already count as done but not in the rate."""
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
        from rich.text import Text

        class RateColumn(TextColumn):
            def render(self, task: Task) -> Text:
                return Text("" if task.speed is None else f"{task.speed:.3g}/s")

        self._bar = Progress(
            BarColumn(),
            TextColumn("{task.completed:.0f} of {task.total:.0f} cases"),
            RateColumn(""),
            TimeRemainingColumn(),
            console=self._console,
            # A task is a whole group of blocks: over rich's 30 s there may be none or one.
            speed_estimate_period=600.0,
        )
        self._task = self._bar.add_task("", total=total_cases, completed=reused)
        self._bar.start()

    def advance(self, cases: int) -> None:
        """Move the bar."""
        if self._bar is not None and self._task is not None:
            self._bar.advance(self._task, cases)

    def fail(self, label: str, reason: str) -> None:
        """Print a line above the bar."""
        self._console.print(f"failed: {label}: {reason}", markup=False, highlight=False)

    def stop(self) -> None:
        """Leave the bar as it stands."""
        if self._bar is not None:
            self._bar.stop()


def make_progress(quiet: bool) -> Progress:
    """A bar on stderr if somebody is there to see it, else silence."""
    if quiet or not sys.stderr.isatty():
        return SilentProgress()
    from rich.console import Console

    return BarProgress(Console(stderr=True))
