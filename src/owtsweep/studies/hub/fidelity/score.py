"""The distance of an interpretation of the paper from its results: one number and its parts.

The score, fixed before the recorded search: the mean absolute log2 ratio of reproduced to published
over the 64 numbers of tables 6-9 (Table 7's misprint judged at 1.98e-3), plus
`WINNER_PENALTY` for each of the four tables whose winner by position (x + y) differs, plus
`BOUNDARY_WEIGHT` times the absolute log2 ratio of the HME1/HME2 boundary to 0.3 m at 4 s and 1 m at
6 s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub import published
from owtsweep.studies.hub.batch import Lanes, sum_errors
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity.boundaries import PUBLISHED
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.schemes import resolve

#: Natural periods (s) that the published numbers need.
PERIODS = (3.0, 4.0, 6.0, 8.0)
MEASURES = ("x", "y", "vx", "vy")
WINNER_PENALTY = 0.5
BOUNDARY_WEIGHT = 0.5
#: The log2 ratio that is used for a boundary that does not exist.
NO_BOUNDARY = 4.0

#: Scheme -> natural period -> (4 measures, 3 products), means over the records.
Products = Mapping[str, Mapping[float, Array]]


def scheme_products(
    config: HubConfig, scheme: str, lanes: Mapping[float, Lanes]
) -> dict[float, Array]:
    """Means of motion, cross and noise products of one scheme, (4, 3) per period.

    The window is `measures.window`.
    """
    resolved = resolve(scheme)
    result = {}
    for period, batch in lanes.items():
        sensors = batch.records.sensors
        settled = round(config.measures.settling_time / sensors.step)
        chain = resolved.kernel(sensors, config, batch.records.steps)  # type: ignore[attr-defined]
        (sums,) = sum_errors([chain], batch.records, settled, consistency=False)
        parts = slice(0, 2) if config.measures.window == "full" else slice(1, 2)
        total = sums.products[parts, :4].sum(axis=0) / sums.steps[parts].sum()
        result[period] = np.asarray(total.mean(axis=2))
    return result


def make_lanes(
    config: HubConfig, replicates: Sequence[int], periods: Sequence[float] = PERIODS
) -> dict[float, Lanes]:
    """Make the records from which a score is computed."""
    return {period: Lanes(make_records(config, period, replicates)) for period in periods}


def at_amplitude(products: Array, amplitude: float) -> Array:
    """The MSE at an amplitude (m), from the three products along the last axis."""
    return np.asarray(superpose(products[..., 0], products[..., 1], products[..., 2], amplitude))


def boundary(lower: Array, upper: Array) -> float:
    """The amplitude (m) above which `upper` has the smaller position MSE, x + y.

    Both are (4, 3) products. NaN if there is none: one scheme is better at every amplitude, or
    `upper` is better below and not above.
    """
    a, c, f = np.sum(lower[:2] - upper[:2], axis=0)  # lower minus upper: < 0 below the boundary
    if f >= 0.0 or a <= 0.0:
        return float("nan")
    return float((-c + np.sqrt(c * c - a * f)) / a)


@dataclass(frozen=True)
class Score:
    """The parts of the score that need all four schemes: winners and boundaries.

    Attributes
    ----------
    penalties
        The sum of both parts of the score; less is better.
    winners
        The scheme of least position MSE in tables 6, 7, 8, 9.
    boundaries
        Natural period (s) -> HME1/HME2 boundary (m).
    """

    penalties: float
    winners: tuple[str, ...]
    boundaries: dict[float, float]


def published_numbers() -> pd.DataFrame:
    """The 64 published numbers, with Table 7's misprint corrected."""
    table = published.mse_tables()
    misprint = (table.table == 7) & (table.scheme == "EKF") & (table.measure == "vx")
    table.loc[misprint, "published"] = 1.98e-3
    return table


def compare(products: Products) -> pd.DataFrame:
    """Published and reproduced numbers of the given schemes, with the log2 of their ratio."""
    table = published_numbers()
    table = table[table.scheme.isin(list(products))].copy()
    keys = zip(table.scheme, table.natural_period, table.amplitude, table.measure, strict=True)
    table["reproduced"] = [
        float(at_amplitude(products[scheme][period][MEASURES.index(measure)], amplitude))
        for scheme, period, amplitude, measure in keys
    ]
    table["log2"] = np.log2(table.reproduced / table.published)
    return table.reset_index(drop=True)


def score(products: Products) -> Score:
    """Judge the winners and boundaries of all four schemes."""
    table = compare(products)
    position = table[table.measure.isin(["x", "y"])]
    sums = position.groupby(["table", "scheme"])[["published", "reproduced"]].sum().reset_index()

    def winners(column: str) -> tuple[str, ...]:
        return tuple(sums.scheme[sums.groupby("table")[column].idxmin()])

    wrong = sum(a != b for a, b in zip(winners("published"), winners("reproduced"), strict=True))
    limits = {p: boundary(products["HME2"][p], products["HME1"][p]) for p in PERIODS}
    parts = np.array([np.log2(limits[period] / target) for period, target in PUBLISHED.items()])
    apart = float(np.sum(np.where(np.isfinite(parts), np.abs(parts), NO_BOUNDARY)))
    penalties = WINNER_PENALTY * wrong + BOUNDARY_WEIGHT * apart
    return Score(penalties, winners("reproduced"), limits)
