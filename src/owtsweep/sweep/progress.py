"""Shows the progress of a sweep, on the terminal or in a log."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Task

#: Seconds between two plain lines.
INTERVAL = 30.0


class Progress:
    """The interface through which a sweep reports its progress; this class shows nothing."""

    def start(self, total_cases: int, reused: int) -> None:
        """Begin to show `total_cases` cases, or add them, of which `reused` are stored already."""

    def look(self, found: str) -> None:
        """Report what a look at the map has found, after which more cases are added."""

    def advance(self, cases: int) -> None:
        """Add a number of finished cases, successful or failed; may be called from any thread."""

    def fail(self, label: str, reason: str, cases: int) -> None:
        """Report failed cases: how many, in the block (unit of work) `label`, for which reason.

        The failed cases count as finished through `advance`, not through this method.
        """

    def stop(self) -> None:
        """Stop showing progress; the sweep is over, whether it has succeeded or not."""


class ConsoleProgress(Progress):
    """The progress of a sweep on a console, told by `rich.progress`.

    It says how many cases are finished and how many of these failed, cases per second since the
    start, and time left. A terminal shows this with a bar; the first failure for each reason is
    printed above the bar, and the command line lists the reasons at the end of the sweep. A file or
    a pipe has it as a plain line at the start, every `INTERVAL` seconds, and at the end. If the
    stream is closed, the sweep goes on without output.
    """

    def __init__(self, console: Console) -> None:
        from rich.progress import BarColumn, Progress, TextColumn
        from rich.text import Text

        class LineColumn(TextColumn):
            def render(self, task: Task) -> Text:
                return Text(_line(task))

        self._console = console
        self._reasons: set[str] = set()
        self._over = threading.Event()
        self._plain = not console.is_terminal
        self._bar = Progress(BarColumn(), LineColumn(""), console=console, disable=self._plain)

    def start(self, total_cases: int, reused: int) -> None:
        """Show the bar, or the first line; the `reused` cases count as finished at once."""
        for task in self._bar.tasks:  # there is one, unless this is the first call
            total, before = (task.total or 0) + total_cases, task.fields["reused"] + reused
            self._bar.update(task.id, total=total, advance=reused, reused=before)
            return
        self._task = self._bar.add_task(
            "", total=total_cases, completed=reused, reused=reused, failed=0
        )
        self._bar.start()
        if self._plain:
            self._say(f"{total_cases} cases, {reused} of them stored already")
            threading.Thread(target=self._tick, daemon=True).start()

    def look(self, found: str) -> None:
        """Print what a look has found, above the bar or as a line."""
        self._say(found)

    def advance(self, cases: int) -> None:
        """Count a number of finished cases."""
        self._bar.advance(self._task, cases)

    def fail(self, label: str, reason: str, cases: int) -> None:
        """Count failed cases; on a terminal, print a line above the bar if the reason is new."""
        failed = self._bar.tasks[0].fields["failed"] + cases
        self._bar.update(self._task, failed=failed)
        if not self._plain and reason not in self._reasons:
            self._reasons.add(reason)
            self._say(f"failed: {label}: {reason}")

    def stop(self) -> None:
        """Stop the bar and leave it on the screen as it is, or print the last line."""
        self._over.set()
        if not self._bar.tasks:
            return  # the sweep ended before its first case
        if self._plain:
            self._say(_line(self._bar.tasks[0]))
        else:
            self._bar.stop()

    def _tick(self) -> None:
        while not self._over.wait(INTERVAL):
            self._say(_line(self._bar.tasks[0]))

    def _say(self, text: str) -> None:
        """Print a line, on a terminal above the bar."""
        if not self._plain:
            self._console.print(text, markup=False, highlight=False)
            return
        try:  # not by rich: it would wrap a line, and end the program if a pipe is closed
            print(text, file=self._console.file, flush=True)
        except (OSError, ValueError):
            self._over.set()


def make_progress() -> Progress:
    """Return the progress of a sweep on stderr."""
    from rich.console import Console

    # Said here, because rich takes the variable FORCE_COLOR for a terminal.
    return ConsoleProgress(Console(stderr=True, force_terminal=sys.stderr.isatty()))


def _line(task: Task) -> str:
    """Return the progress as text; `task` is what rich has counted."""
    done, total = int(task.completed), int(task.total or 0)
    seconds = task.elapsed or 0.0
    rate = (done - task.fields["reused"]) / seconds if seconds > 0.0 else 0.0
    line = f"{done} of {total} cases, {task.fields['failed']} failed, {_rate(rate)}"
    if rate > 0.0 and done < total:
        line += f", {_duration((total - done) / rate)} left"
    return line


def _rate(rate: float) -> str:
    """Return cases per second as text with three digits that count, e.g. "1 390 cases/s"."""
    if rate < 999.5:
        return f"{rate:.3g} cases/s"
    return f"{float(f'{rate:.3g}'):,.0f} cases/s".replace(",", " ")


def _duration(seconds: float) -> str:
    """Return a duration, given in seconds, as text, e.g. "45 s", "12 min" or "3 h 20 min"."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
