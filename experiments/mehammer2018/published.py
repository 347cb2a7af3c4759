"""What Mehammer et al. (2018) say, and the numbers in the author's files, as data.

Statements are in our words, each with the numeric reading by which it is judged.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

HERE = Path(__file__).parent


def read_facts() -> pd.DataFrame:
    """Read what the text says about results.

    Columns: id (F1 to F10), section, quantity, statement, reading.
    """
    return _read("facts", "section")


def read_stored_tests() -> pd.DataFrame:
    """Read the rms errors and r^2 that the author's files hold of 22 tests, 12 states each.

    Columns: test, measure (rms_error or r2), state (x ... r: positions and velocities; m, rad, and
    per s), value.
    """
    return _read("stored_tests", "test")


def read_author_record() -> pd.DataFrame:
    """Read what the author's record of the buoy and SIMA's record say (reference [12]).

    Made by author_record.py, which says how. Columns: state (x, y, z), measure (rms_error and
    drift, m; velocity_rms and high, m/s; lag, ms), estimate, value.
    """
    return _read("author_record")


def _read(name: str, *text: str) -> pd.DataFrame:
    """Read a table of this folder; columns in `text` are no numbers, although they look so."""
    import pandas as pd

    return pd.read_csv(HERE / f"{name}.csv", dtype=dict.fromkeys(text, str))
