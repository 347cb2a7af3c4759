"""The conditions of the hub study: natural period and amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition, Grid

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.results.cube import Cube
    from owtsweep.studies.hub.config import HubConfig

NATURAL_PERIOD = Condition(
    "natural_period", "natural period", "s", in_streams=True, plural="periods"
)
AMPLITUDE = Condition(
    "amplitude", "motion amplitude", "m", scale="log", expands=True, plural="amplitudes"
)
CONDITIONS = (NATURAL_PERIOD, AMPLITUDE)
#: The order of measures in tables.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: The measures that decide whether two schemes coincide.
CRITERIA = ("position", "velocity")
#: The schemes whose boundary is reported: the first is better at amplitudes below the boundary,
#: the second above.
BOUNDARY = ("HME2", "HME1")


def get_grid(config: HubConfig) -> Grid:
    """Return name of a condition -> list of the values that the configuration gives it."""
    return {"natural_period": config.grid.natural_period, "amplitude": config.grid.amplitude}


def make_cube(config: HubConfig, rows: pd.DataFrame, *, baselines: bool = False) -> Cube:
    """Arrange a run's rows as arrays over schemes, conditions, measures and replicates (a cube).

    With `baselines` the cube holds the run's baselines too, after the schemes.
    """
    from owtsweep.results.cube import Cube
    from owtsweep.studies.hub import baseline_names, scheme_names

    names = scheme_names(config) + (baseline_names(config) if baselines else [])
    return Cube.of_rows(rows, names, CONDITIONS, get_grid(config), measures=MEASURES)
