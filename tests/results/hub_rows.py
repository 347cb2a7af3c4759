"""Rows and values of the hub study, and what the result tables make of them."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pandas as pd

from owtsweep.results.best_scheme import find_best_schemes, find_coinciding
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise
from owtsweep.studies.hub.measures import CRITERIA, MEASURES
from owtsweep.studies.hub.worlds import CONDITIONS

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
PERIODS = (3.0, 8.0)
AMPLITUDES = (0.05, 1.0, 10.0)


def make_cube(values, schemes) -> Cube:
    """The cube of values, each of them a row that was run directly."""
    rows = values.assign(status="ok", motion=math.nan, cross=math.nan, noise=math.nan)
    return Cube.of_rows(
        rows, schemes, CONDITIONS, {"amplitude": values["amplitude"].unique()}, measures=MEASURES
    )


def tabulate(rows, amplitudes=AMPLITUDES) -> pd.DataFrame:
    """One line per value."""
    schemes = list(rows["scheme"].unique())
    return Cube.of_rows(rows, schemes, CONDITIONS, {"amplitude": amplitudes}).to_table()


def make_summary(values, schemes) -> pd.DataFrame:
    return summarise(make_cube(values, schemes))


def find_best(values, schemes, window, criteria=CRITERIA) -> pd.DataFrame:
    cube = make_cube(values, schemes)
    return find_best_schemes(cube, window, criteria)


def coinciding(values, schemes) -> list[tuple[str, ...]]:
    return find_coinciding(make_cube(values, schemes), CRITERIA)


def superposed_rows(
    schemes=SCHEMES,
    replicates: int = 6,
    measures=("x", "position", "velocity", "nees"),
    seed: int = 5,
) -> pd.DataFrame:
    random = np.random.default_rng(seed)
    rows = []
    cases = product(PERIODS, schemes, range(replicates), measures, ("full", "settled"))
    for period, scheme, replicate, measure, window in cases:
        motion, noise = random.uniform(0.5, 1.5, 2) * (2e-3, 1e-3)
        rows.append(
            {
                "natural_period": period,
                "replicate": replicate,
                "scheme": scheme,
                "measure": measure,
                "window": window,
                "amplitude": math.nan,
                "motion": motion,
                "cross": random.normal(scale=1e-5),
                "noise": noise,
                "value": math.nan,
                "n_samples": 1000,
                "status": "ok",
                "reason": "",
            }
        )
    return pd.DataFrame(rows)


def values_of(samples: dict[str, list[float]], *, amplitude: float = 1.0, **fixed) -> pd.DataFrame:
    """Values of one cell: a list of replicates per scheme; NaN stands for one not finished."""
    rows = [
        {
            "scheme": scheme,
            "natural_period": 3.0,
            "amplitude": amplitude,
            "measure": "position",
            "window": "full",
            "replicate": replicate,
            "value": value,
        }
        | fixed
        for scheme, series in samples.items()
        for replicate, value in enumerate(series)
        if not math.isnan(value)
    ]
    return pd.DataFrame(rows)


def best_of(samples: dict[str, list[float]], schemes=None) -> pd.Series:
    values = values_of(samples)
    table = find_best(values, schemes or list(samples), "full", criteria=("position",))
    assert len(table) == 1
    return table.iloc[0]
