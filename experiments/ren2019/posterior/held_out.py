"""Predict what the likelihood did not use: statements of the text, and two boundaries.

Each is judged on single records, as the paper has one. The tests are those of `claims.toml`, with
two simplifications. F9 and F11 take errors as normal, so a record's mean square says which share
lies within a limit and which accumulated error is the less; F11's bias is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from scipy.special import erf

from experiments.ren2019.evidence import AMPLITUDES, SCHEMES, tolerated
from experiments.ren2019.evidence import PERIODS as GRID
from experiments.ren2019.posterior.components import make_chains
from experiments.ren2019.posterior.inference import name_settings
from experiments.ren2019.posterior.records import configure, measure
from experiments.ren2019.posterior.settings import Reading
from owtsweep.arrays import Array
from owtsweep.results.superposition import find_crossing, superpose
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Feed, make_records

#: Natural period (s) and amplitude (m) of the time histories, F9 and F11.
HISTORY = (3.8, 0.5)
PERIODS = (*GRID, HISTORY[0])
#: Limit of F9, m/s, and the share of samples that must lie within.
LIMIT, SHARE = 0.05, 0.95
#: Statements and boundaries that the 64 numbers do not hold. F4 and F3 are the boundaries' own.
STATEMENTS = ("F1", "F2", "F3", "F4", "F5", "F9", "F11")
#: All of them: the whole figure.
ALL = "all"
#: Statement -> natural period of the boundary between HME2 and HME1 that it is about, s.
BOUNDARY = {"F3": 4.0, "F4": 6.0}
#: Two errors within this ratio are "nearly equal" (`claims.toml`, F2).
NEARLY = 0.8


class Map(NamedTuple):
    """Mean squares of one record each.

    grid: shape (criteria, periods, amplitudes, schemes, records); the criteria are x and x + y.
    boundary: amplitude at which HME1 and HME2 are equal, m, shape (criteria, periods, records);
        without one, 0 where HME1 is the better at small amplitudes, infinite where HME2 is.
    history: at `HISTORY`, of x, y, vx and vy, shape (schemes, 4, records).
    """

    grid: Array
    boundary: Array
    history: Array


def simulate_map(reading: Reading, settings: Mapping[str, float], replicates: range) -> Map:
    """Simulate up to eight records of the paper's figure 18 under a reading, shapes as `Map`."""
    assert len(replicates) <= WIDTH
    config, count = configure(reading, settings), len(replicates)
    steps = make_records(config, GRID[0], [0]).steps
    chains = make_chains(settings, steps)
    made = np.empty((len(PERIODS), len(SCHEMES), 4, 3, count))
    for line, period in enumerate(PERIODS):
        feed = Feed(make_records(config, period, replicates))
        means, peaks = measure(chains, feed, reading)
        scale = np.stack([peaks**-2, peaks**-1, np.ones(WIDTH)])  # the largest |d| is 1 m
        made[line] = (means * scale)[..., :count]
    both = np.stack([made[:, :, 0], made[:, :, :2].sum(axis=2)])  # x, and x + y
    sizes = np.array(AMPLITUDES)[:, None, None]
    grid = both[:, : len(GRID), None]
    mse = superpose(grid[..., 0, :], grid[..., 1, :], grid[..., 2, :], sizes)
    less = both[:, : len(GRID), SCHEMES.index("HME2")] - both[:, : len(GRID), SCHEMES.index("HME1")]
    history = superpose(made[-1, :, :, 0], made[-1, :, :, 1], made[-1, :, :, 2], HISTORY[1])
    return Map(mse, find_boundaries(less), history)


def find_boundaries(less: Array) -> Array:
    """Return the amplitude, m, from which HME1 is the better; see `Map.boundary`.

    less: motion, cross and noise of HME2's mean square less HME1's, shape (..., 3, records).
    """
    rows = np.moveaxis(less, -2, -1)
    found = find_crossing(rows.reshape(-1, 3)).reshape(rows.shape[:-1])
    without = np.where(rows[..., 2] >= 0.0, 0.0, np.inf)
    return np.where(np.isnan(found), without, found)


def judge(made: Map, criterion: int) -> dict[str, Array]:
    """Return statement -> whether it holds in each record, shape (records,).

    criterion: 0 judges x alone, 1 judges x + y.
    """
    grid, boundary = made.grid[criterion], made.boundary[criterion]
    best = grid.argmin(axis=2)
    ekf, mkf, hme1, hme2 = range(4)
    small = AMPLITUDES.index(0.05), AMPLITUDES.index(0.1)
    at = AMPLITUDES.index(0.5)
    close = grid[1:3, at, mkf:]  # at 4 and 5 s
    others = np.ones(best.shape[:2], dtype=bool)
    others[1:3, at] = False
    four, eight = (boundary[GRID.index(period)] for period in (4.0, 8.0))
    finite = (boundary > AMPLITUDES[0]) & (boundary < AMPLITUDES[-1])
    rms = np.sqrt(made.history)
    velocity = rms[[hme1, hme2], 2:]
    along = rms[:, 0] if criterion == 0 else rms[:, :2].sum(axis=1)
    speed = rms[:, 2] if criterion == 0 else rms[:, 2:].sum(axis=1)
    return {
        "F1": (best[:, small[0]] == ekf).all(axis=0)
        & (best[:, small[1] :] != ekf).all(axis=(0, 1)),
        "F2": (best[1:3, at] == mkf).all(axis=0)
        & (best[others] != mkf).all(axis=0)
        & (close.min(axis=1) > NEARLY * close.max(axis=1)).all(axis=0),
        **{name: _is_tolerated(boundary, period) for name, period in BOUNDARY.items()},
        "F5": finite.all(axis=0)
        & (eight > four)
        & (best[0, -1] == hme1)
        & (best[-1, small[1]] == hme2),
        "F9": (erf(LIMIT / np.sqrt(2.0) / velocity).mean(axis=1) > SHARE).all(axis=0),
        "F11": (along[hme1] < along[hme2]) & (speed[hme2] < speed[hme1]),
    }


def _is_tolerated(boundary: Array, period: float) -> Array:
    low, high = tolerated(period)
    found = boundary[GRID.index(period)]
    return np.asarray((found > low) & (found < high))


def tabulate(name: str, reading: Reading, points: Array) -> pd.DataFrame:
    """Return the share of records in which each statement holds, over points of the cube.

    Columns source, criterion (x, position), statement, probability, records, and of boundaries the
    median and 95 % at 4 and 6 s, m, in `low`, `median`, `high`.
    """
    settings = [name_settings(point) for point in points]
    jobs = (delayed(simulate_map)(reading, each, range(WIDTH)) for each in settings)
    return _share(name, Parallel(2, backend="multiprocessing")(jobs))


def tabulate_settings(
    name: str, reading: Reading, settings: Mapping[str, float], records: int = 64
) -> pd.DataFrame:
    """Return the table of `tabulate` for one set of settings, over records."""
    parts = [range(first, first + WIDTH) for first in range(0, records, WIDTH)]
    jobs = (delayed(simulate_map)(reading, settings, part) for part in parts)
    return _share(name, Parallel(2, backend="multiprocessing")(jobs))


def _share(name: str, maps: list[Map]) -> pd.DataFrame:
    rows = []
    for criterion, label in enumerate(("x", "position")):
        judged = [judge(each, criterion) for each in maps]
        bounds = np.concatenate([each.boundary[criterion] for each in maps], axis=1)
        held = {name: np.concatenate([each[name] for each in judged]) for name in STATEMENTS}
        held[ALL] = np.all([*held.values()], axis=0)
        for statement, holds in held.items():
            row = {"source": name, "criterion": label, "statement": statement,
                   "probability": holds.mean(), "records": len(holds)}  # fmt: skip
            if statement in BOUNDARY:
                ends = np.quantile(bounds[GRID.index(BOUNDARY[statement])], [0.025, 0.5, 0.975],
                                   method="nearest")  # fmt: skip
                row |= dict(zip(("low", "median", "high"), ends, strict=True))
            rows.append(row)
    return pd.DataFrame(rows)
