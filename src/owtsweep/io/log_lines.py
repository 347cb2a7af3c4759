"""Turns logged messages into printable lines; schemes and libraries may log any characters."""

from __future__ import annotations

import logging

from owtsweep.errors import as_text, printable


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
