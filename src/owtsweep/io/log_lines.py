"""Makes logged messages printable lines, because schemes and libraries log what they like."""

from __future__ import annotations

import logging

from owtsweep.errors import as_text, printable


def read_message(record: logging.LogRecord) -> str:
    """Return the message of a log record; if it cannot be formatted, a text that says so."""
    try:
        return record.getMessage()
    except Exception as error:  # the text and its arguments are a scheme's or a library's
        return f"{record.msg!r} cannot be formatted ({as_text(error)})"


class Lines(logging.Formatter):
    """The formatter that makes printable lines of a log record.

    All lines of a message but the first are indented, so that none looks like a new message.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return the record's lines, joined by line breaks; a traceback's lines are included."""
        plain = logging.makeLogRecord({**vars(record), "msg": self.text(record), "args": None})
        first, *more = super().format(plain).splitlines()
        return "\n".join([printable(first), *(f"  {printable(line)}" for line in more)])

    def text(self, record: logging.LogRecord) -> str:
        """Return the text that is written as the record's message; a subclass may override this."""
        return read_message(record)
