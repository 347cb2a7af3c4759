"""Writes run.log in the run folder: the messages that a sweep and its workers log, with times.

The file has the messages of `owtsweep` from level INFO up. From other loggers (of a user's scheme
or a library) the file has messages from level WARNING up. Python's warnings are logged too. Schemes
and libraries may log any characters; what is written is printable.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path

from owtsweep.errors import as_text, printable
from owtsweep.io.files import unwritable

#: Most log entries of a task that its worker sends back; a scheme may warn at every step.
MOST_ENTRIES = 50


_label = ContextVar("label", default="")  # each thread has its own
_capturing = threading.Lock()
_captures = 0


@dataclass(frozen=True)
class LogEntry:
    """A logged message that a worker sends back; it has plain values, so that it can be pickled.

    `name` is the logger's name, `level` the level of Python's logging, and `created` the time in
    seconds since 1970.
    """

    name: str
    level: int
    created: float
    message: str


def working_on(label: str) -> None:
    """Set the label that run.log shows with each message of the current thread.

    The label is that of the block (unit of work) that the thread runs; "" shows no label.
    """
    _label.set(label)


@contextmanager
def run_log(folder: Path) -> Iterator[None]:
    """Append logged messages to the file `run.log` in `folder` while the context is open.

    Raises InputError if the file cannot be opened. Later errors while writing the file are ignored.
    """
    try:
        handler = _Quiet(folder / "run.log", encoding="utf-8")
    except OSError as error:
        raise unwritable(folder, error) from error
    formatter = _Labelled("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%dT%H:%M:%SZ")
    formatter.converter = time.gmtime
    handler.setFormatter(formatter)
    try:
        with _listening(handler):
            yield
    finally:
        handler.close()


@contextmanager
def collect_entries(elsewhere: bool) -> Iterator[list[LogEntry]]:
    """Yield a list that receives what the current thread logs while the context is open.

    `elsewhere` says whether the thread runs in another process than the sweep. If `elsewhere` is
    False, the list stays empty, because the sweep's `run_log` receives the messages itself. The
    list has at most `MOST_ENTRIES` messages. If more were logged, a last message says how many were
    left out.
    """
    entries: list[LogEntry] = []
    if not elsewhere:
        yield entries
        return
    handler = _Collector(entries)
    with _listening(handler):
        yield entries
    if handler.dropped:
        text = f"{handler.dropped} more messages of this task were left out"
        entries.append(LogEntry("owtsweep", logging.WARNING, time.time(), text))


def repeat(entries: Sequence[LogEntry]) -> None:
    """Log the entries that a worker has sent back, with their original times."""
    for entry in entries:
        logger = logging.getLogger(entry.name)
        copy = logger.makeRecord(entry.name, entry.level, "", 0, entry.message, (), None)
        copy.created = entry.created
        copy.from_worker = True
        logger.handle(copy)


@contextmanager
def _listening(handler: logging.Handler) -> Iterator[None]:
    global _captures

    root, ours = logging.getLogger(), logging.getLogger("owtsweep")
    level = ours.level
    handler.setLevel(logging.INFO)
    handler.addFilter(_wanted)
    root.addHandler(handler)
    if ours.getEffectiveLevel() > logging.INFO:
        ours.setLevel(logging.INFO)
    with _capturing:  # on other machines several threads run tasks at once
        _captures += 1
        logging.captureWarnings(True)
    try:
        yield
    finally:
        with _capturing:
            _captures -= 1
            if not _captures:
                logging.captureWarnings(False)
        ours.setLevel(level)
        root.removeHandler(handler)


class _Quiet(logging.FileHandler):
    """A log file that ignores errors: a full disk neither prints tracebacks nor ends the sweep."""

    def handleError(self, record: logging.LogRecord) -> None:
        pass

    def close(self) -> None:
        with suppress(OSError):
            super().close()


class _Collector(logging.Handler):
    def __init__(self, entries: list[LogEntry]) -> None:
        super().__init__()
        self.entries = entries
        self.dropped = 0
        self._thread = threading.get_ident()

    def emit(self, record: logging.LogRecord) -> None:
        if record.thread != self._thread:
            return
        if len(self.entries) >= MOST_ENTRIES:
            self.dropped += 1
            return
        text = _text(record)
        self.entries.append(LogEntry(record.name, record.levelno, record.created, text))


def _wanted(record: logging.LogRecord) -> bool:
    return record.name.split(".")[0] == "owtsweep" or record.levelno >= logging.WARNING


def _text(record: logging.LogRecord) -> str:
    label, text = _label.get(), read_message(record)
    if record.name == "py.warnings":
        text = " ".join(text.split())
    return f"{label}: {text}" if label else text


def read_message(record: logging.LogRecord) -> str:
    """Return the message of a log record, or a text saying that the message cannot be formatted."""
    try:
        return record.getMessage()
    except Exception as error:  # the text and its arguments are a scheme's or a library's
        return f"{record.msg!r} cannot be formatted ({as_text(error)})"


class Lines(logging.Formatter):
    """A logging formatter that turns a log record into printable lines.

    The first line of a message is not indented. All further lines are, so that none of them looks
    like a new message.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return the record's lines, joined by line breaks; a traceback's lines are included."""
        plain = logging.makeLogRecord({**vars(record), "msg": self.text(record), "args": None})
        first, *more = super().format(plain).splitlines()
        return "\n".join([printable(first), *(f"  {printable(line)}" for line in more)])

    def text(self, record: logging.LogRecord) -> str:
        """Return the text to write as the record's message; a subclass may override this method."""
        return read_message(record)


class _Labelled(Lines):
    """The formatter of run.log, which adds to a message the label that `working_on` has set."""

    def text(self, record: logging.LogRecord) -> str:
        return read_message(record) if "from_worker" in vars(record) else _text(record)
