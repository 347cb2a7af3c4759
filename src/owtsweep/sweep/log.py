"""Writes run.log in the run folder: the messages that a sweep and its workers log, with times.

The file has the messages of `owtsweep` from level INFO up. From other loggers (of a user's scheme
or a library) the file has messages from level WARNING up. Python's warnings are logged too. Schemes
and libraries may log any characters; what is written is printable.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from owtsweep.errors import as_text, printable
from owtsweep.io.files import unwritable

#: Most messages of a task that its worker sends back; a scheme may warn at every step.
MOST_RECORDS = 50

_label = ContextVar("label", default="")  # each thread has its own
_capturing = threading.Lock()
_captures = 0


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
    formatter = Lines("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%dT%H:%M:%SZ", _label_text)
    formatter.converter = time.gmtime
    handler.setFormatter(formatter)
    try:
        with _listening(handler):
            yield
    finally:
        handler.close()


@contextmanager
def collect_records(elsewhere: bool) -> Iterator[list[logging.LogRecord]]:
    """Yield a list that receives what the current thread logs while the context is open.

    The records are plain: a text with its label, without arguments, so that they can be pickled.
    `elsewhere` says whether the thread runs in another process than the sweep. If `elsewhere` is
    False, the list stays empty, because the sweep's `run_log` receives the messages itself. The
    list has at most `MOST_RECORDS` messages. If more were logged, a last message says how many were
    left out.
    """
    records: list[logging.LogRecord] = []
    if not elsewhere:
        yield records
        return
    handler = _Collector(records)
    with _listening(handler):
        yield records
    if handler.dropped:
        text = f"{handler.dropped} more messages of this task were left out"
        records.append(_make_plain("owtsweep", logging.WARNING, time.time(), text))


def repeat(records: Sequence[logging.LogRecord]) -> None:
    """Log the records that a worker has sent back, with their original times."""
    for record in records:
        logging.getLogger(record.name).handle(record)


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
    def __init__(self, records: list[logging.LogRecord]) -> None:
        super().__init__()
        self.records = records
        self.dropped = 0
        self._thread = threading.get_ident()

    def emit(self, record: logging.LogRecord) -> None:
        if record.thread != self._thread:
            return
        if len(self.records) >= MOST_RECORDS:
            self.dropped += 1
            return
        text = _label_text(record)
        self.records.append(_make_plain(record.name, record.levelno, record.created, text))


def _make_plain(name: str, level: int, created: float, text: str) -> logging.LogRecord:
    """Return a record of a worker; `created` is in seconds since 1970."""
    record = logging.LogRecord(name, level, "", 0, text, None, None)
    record.created = created
    record.from_worker = True
    return record


def _wanted(record: logging.LogRecord) -> bool:
    return record.name.split(".")[0] == "owtsweep" or record.levelno >= logging.WARNING


def _label_text(record: logging.LogRecord) -> str:
    """Return a record's message after the label that `working_on` has set; a worker's has it."""
    label, text = _label.get(), read_message(record)
    if "from_worker" in vars(record):
        return text
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
    like a new message. `read` returns the text to write as a record's message.
    """

    def __init__(
        self,
        form: str,
        times: str | None = None,
        read: Callable[[logging.LogRecord], str] = read_message,
    ) -> None:
        super().__init__(form, times)
        self._read = read

    def format(self, record: logging.LogRecord) -> str:
        """Return the record's lines, joined by line breaks; a traceback's lines are included."""
        plain = logging.makeLogRecord({**vars(record), "msg": self._read(record), "args": None})
        first, *more = super().format(plain).splitlines()
        return "\n".join([printable(first), *(f"  {printable(line)}" for line in more)])
