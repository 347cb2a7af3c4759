"""Reads the numbers in the author's files. What the paper says stands in claims.toml."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

HERE = Path(__file__).parent


def read_stored_tests() -> pd.DataFrame:
    """Read the rms errors and r^2 that the author's files hold of 22 tests, 12 states each.

    Columns: test, measure (rms_error or r2), state (x ... r: positions and velocities; m, rad, and
    per s), value.
    """
    return pd.read_csv(HERE / "stored_tests.csv", dtype={"test": str})


def read_author_record() -> pd.DataFrame:
    """Read what the author's record of the buoy and SIMA's record say (reference [12]).

    Made by author_record.py, which says how. Columns: state (x, y, z), measure (rms_error and
    drift, m; velocity_rms and high, m/s; lag, ms), estimate, value.
    """
    return pd.read_csv(HERE / "author_record.csv")
