"""Shows the progress of a sweep, on the terminal or in a log."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Task

#: Seconds between two lines of `LineProgress`.
INTERVAL = 30.0


class Progress:
    """The interface through which a sweep reports its progress; this class shows nothing."""

    def start(self, total_cases: int, reused: int) -> None:
        """Begin to show a sweep of `total_cases` cases, of which `reused` are stored already."""

    def advance(self, cases: int) -> None:
        """Add a number of finished cases, successful or failed; may be called from any thread."""

    def fail(self, label: str, reason: str, cases: int) -> None:
        """Report failed cases: how many, in the block (unit of work) `label`, for which reason.

        The failed cases count as finished through `advance`, not through this method.
        """

    def stop(self) -> None:
        """Stop showing progress; the sweep is over, whether it has succeeded or not."""


class LineProgress(Progress):
    """The progress of a sweep as plain lines: at the start, every 30 s and at the end.

    Parameters
    ----------
    stream
        The stream to which lines are printed. If the stream is closed, the sweep goes on without
        output.
    clock
        A function that returns the present time in seconds, as `time.monotonic` does.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._total = self._reused = self._done = self._failed = 0
        self._began = self._said = 0.0

    def start(self, total_cases: int, reused: int) -> None:
        """Print how many cases there are and how many are stored; then print a line every 30 s."""
        self._total, self._reused, self._done = total_cases, reused, reused
        self._began = self._said = self._clock()
        self._say(f"{total_cases} cases, {reused} of them stored already")
        threading.Thread(target=self._tick, daemon=True).start()

    def advance(self, cases: int) -> None:
        """Count a number of finished cases, successful or failed; nothing is printed."""
        with self._lock:
            self._done += cases

    def fail(self, label: str, reason: str, cases: int) -> None:
        """Count a number of failed cases, which the next printed line shows.

        `label` and `reason` are not used.
        """
        with self._lock:
            self._failed += cases

    def look(self) -> None:
        """Print a line on the progress if 30 s have passed since the last line."""
        if self._clock() - self._said >= INTERVAL:
            self._said = self._clock()
            self._say(self._line())

    def stop(self) -> None:
        """Print a last line on the progress, if the sweep has begun to compute; stop printing."""
        self._over.set()
        if self._total:
            self._say(self._line())

    def _tick(self) -> None:
        while not self._over.wait(1.0):
            self.look()

    def _line(self) -> str:
        with self._lock:
            done, failed = self._done, self._failed
        seconds = self._clock() - self._began
        rate = (done - self._reused) / seconds if seconds > 0.0 else 0.0
        line = f"{done} of {self._total} cases, {failed} failed, {_rate(rate)}"
        if rate > 0.0 and done < self._total:
            line += f", {_duration((self._total - done) / rate)} left"
        return line

    def _say(self, text: str) -> None:
        try:
            print(text, file=self._stream, flush=True)
        except (OSError, ValueError):
            self._over.set()


class BarProgress(Progress):
    """The progress of a sweep as a bar: cases finished and failed, cases per second, time left.

    The first failure for each reason is printed as a line above the bar. Further failures are only
    counted; the command line lists the reasons at the end of the sweep.
    """

    def __init__(self, console: Console) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
        from rich.text import Text

        self._console = console
        self._reasons: set[str] = set()
        self._failed = 0

        class RateColumn(TextColumn):
            def render(self, task: Task) -> Text:
                return Text("" if task.speed is None else _rate(task.speed))

        self._bar = Progress(
            BarColumn(),
            TextColumn("{task.completed:.0f} of {task.total:.0f} cases{task.fields[failed]}"),
            RateColumn(""),
            TimeRemainingColumn(),
            console=self._console,
            # A task is a whole group of blocks: within rich's default of 30 s few or none may end.
            speed_estimate_period=600.0,
        )

    def start(self, total_cases: int, reused: int) -> None:
        """Show the bar; the `reused` cases count as finished, but not in the cases per second."""
        self._task = self._bar.add_task("", total=total_cases, completed=reused, failed="")
        self._bar.start()

    def advance(self, cases: int) -> None:
        """Move the bar by a number of finished cases."""
        self._bar.advance(self._task, cases)

    def fail(self, label: str, reason: str, cases: int) -> None:
        """Count failed cases, and print a line above the bar if the reason is new."""
        self._failed += cases
        self._bar.update(self._task, failed=f", {self._failed} failed")
        if reason not in self._reasons:
            self._reasons.add(reason)
            self._console.print(f"failed: {label}: {reason}", markup=False, highlight=False)

    def stop(self) -> None:
        """Stop the bar and leave it on the screen as it is."""
        if self._bar.live.is_started:
            self._bar.stop()


def make_progress() -> Progress:
    """Return a `BarProgress` if stderr is a terminal; otherwise a `LineProgress`."""
    if not sys.stderr.isatty():
        return LineProgress(sys.stderr)
    from rich.console import Console

    return BarProgress(Console(stderr=True))


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
