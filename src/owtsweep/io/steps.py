"""Tells the steps of a command that takes long, as lines on the terminal."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_logger = logging.getLogger("owtsweep.steps")


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
