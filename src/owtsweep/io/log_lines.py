"""Logged messages as printable lines: schemes and libraries log what they like."""

from __future__ import annotations

import logging

from owtsweep.errors import as_text, printable


def read_message(record: logging.LogRecord) -> str:
    """The message of a record. Where its arguments do not fit its text, it says so."""
    try:
        return record.getMessage()
    except Exception as error:  # the text and its arguments are a scheme's or a library's
        return f"{record.msg!r} cannot be formatted ({as_text(error)})"


class Lines(logging.Formatter):
    """Formats printable lines. Lines after a message's first are indented: none looks like a new
    message.
    """

    def format(self, record: logging.LogRecord) -> str:
        """The lines of a record, and of its traceback if it has one."""
        plain = logging.makeLogRecord({**vars(record), "msg": self.text(record), "args": None})
        first, *more = super().format(plain).splitlines()
        return "\n".join([printable(first), *(f"  {printable(line)}" for line in more)])

    def text(self, record: logging.LogRecord) -> str:
        """What is written as the message."""
        return read_message(record)
