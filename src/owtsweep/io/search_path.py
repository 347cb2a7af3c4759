"""Keeps the current folder off the search path for modules of processes that are started here."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

#: The environment variable by which Python leaves the current folder off its search path, as -P.
_VARIABLE = "PYTHONSAFEPATH"


@contextmanager
def no_modules_of_this_folder() -> Iterator[None]:
    """Let processes that are started inside the context import nothing from the current folder.

    joblib and Hydra's launchers start their workers by `python -m` and `python -c`, which search
    the current folder first: a file joblib.py there, perhaps a stranger's, would be run. Folders of
    PYTHONPATH are searched as ever. If this process itself searches the current folder (`python -m
    owtsweep`), so do its workers, and nothing is changed.
    """
    before = os.environ.get(_VARIABLE)
    here = os.getcwd()
    if before or any(os.path.abspath(folder) == here for folder in sys.path):
        yield
        return
    os.environ[_VARIABLE] = "1"
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(_VARIABLE, None)
        else:
            os.environ[_VARIABLE] = before
