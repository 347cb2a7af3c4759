"""What Mehammer et al. (2018) say, and the numbers in the author's files, as data.

Statements are in our words, each with the numeric reading by which it is judged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.verdicts.published import read_published

if TYPE_CHECKING:
    import pandas as pd

#: The package whose folder `data/` holds what is printed.
PACKAGE = "owtsweep.studies.floater"


def read_facts() -> pd.DataFrame:
    """Read what the text says about results.

    Columns: id (F1 to F10), section, quantity, statement, reading.
    """
    return read_published(PACKAGE, "mehammer2018_facts.csv", text=("section",))


def read_stored_tests() -> pd.DataFrame:
    """Read the rms errors and r^2 that the author's files hold of 22 tests, 12 states each.

    Columns: test, measure (rms_error or r2), state (x ... r: positions and velocities; m, rad, and
    per s), value.
    """
    return read_published(PACKAGE, "mehammer2018_stored_tests.csv", text=("test",))


def read_author_record() -> pd.DataFrame:
    """Read what the author's record of the buoy and SIMA's record say (reference [12]).

    Made by experiments/floater/author_record.py, which says how. Columns: state (x, y, z), measure
    (rms_error and drift, m; velocity_rms and high, m/s; lag, ms), estimate, value.
    """
    return read_published(PACKAGE, "mehammer2018_record.csv")
