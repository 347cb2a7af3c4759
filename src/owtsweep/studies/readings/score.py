"""Compute the score of an interpretation of the paper: its distance from the published results.

The paper is Ren et al. (2019). The score is the sum of three parts. This sum was fixed before the
recorded search for an interpretation. The first part is the mean of |log2(reproduced / published)|
over the 64 numbers of tables 6-9 (Table 7's misprint is judged at 1.98e-3). The second part is
`WINNER_PENALTY` for each of the four tables whose scheme of least position MSE (x + y) is not the
published one. The third part concerns the boundary, the amplitude at which HME1 and HME2 are
equally good: published as 0.3 m at 4 s and 1 m at 6 s. This part is `BOUNDARY_WEIGHT` times the sum
of |log2(reproduced / published)| over both boundaries.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import Plain, with_values
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub.public import HubConfig, Known, Lanes, make_records, resolve, sum_errors
from owtsweep.studies.readings.published import BOUNDARIES, published_numbers

#: Natural periods (s) that the published numbers need.
PERIODS = (3.0, 4.0, 6.0, 8.0)
#: The schemes with a published boundary: the first is better below it, the second above.
BOUNDED = ("HME2", "HME1")
MEASURES = ("x", "y", "vx", "vy")
WINNER_PENALTY = 0.5
BOUNDARY_WEIGHT = 0.5
#: The value of |log2(reproduced / published)| for a boundary that does not exist in the run.
NO_BOUNDARY = 4.0

#: Scheme -> natural period (s) -> means over the records, shape (4, 3): rows x, y, vx, vy, columns
#: the products motion, cross, noise.
Products = Mapping[str, Mapping[float, Array]]


def scheme_products(
    config: HubConfig, scheme: str, lanes: Mapping[float, Lanes]
) -> dict[float, Array]:
    """Run one scheme; average the products of its errors from motion and noise over the records.

    `config`: `measures.window` selects the part of each record that counts. `scheme`: name of a
    scheme with a batch kernel. `lanes`: natural period (s) -> records, as `make_lanes` returns
    them.

    Return natural period (s) -> products, shape (4, 3): rows x, y, vx, vy, columns motion, cross,
    noise.
    """
    resolved = resolve(scheme)
    result: dict[float, Array] = {}
    chain = None
    for period, batch in lanes.items():
        sensors = batch.records.sensors
        settled = config.measures.find_settled(sensors.step)
        if chain is None:  # its gains do not depend on the period, and take most of the time
            chain = resolved.kernel(Known(sensors, config), batch.records.steps)
        (sums,) = sum_errors([chain], batch.records, settled, consistency=False)
        parts = slice(0, 2) if config.measures.window == "full" else slice(1, 2)
        total = sums.products[parts, :4].sum(axis=0) / sums.steps[parts].sum()
        result[period] = np.asarray(total.mean(axis=2))
    return result


def make_lanes(
    config: HubConfig, replicates: Sequence[int], periods: Sequence[float] = PERIODS
) -> dict[float, Lanes]:
    """Return natural period (s) -> the records from which a score is computed."""
    return {period: Lanes(make_records(config, period, replicates)) for period in periods}


def at_amplitude(products: Array, amplitude: float) -> Array:
    """Compute the MSE at an amplitude (m) from `scheme_products`, by superposition, shape (4,)."""
    return np.asarray(superpose(products[..., 0], products[..., 1], products[..., 2], amplitude))


def boundary(lower: Array, upper: Array) -> float:
    """Compute the amplitude (m) below which one scheme has the smaller MSE, and above it another.

    The MSE is that of position, x + y. `lower` and `upper` are products, shape (4, 3), of the
    scheme that is better below and of that above. NaN if there is no such amplitude: one scheme is
    better at every amplitude, or `upper` is better at small amplitudes.
    """
    a, c, f = np.sum(lower[:2] - upper[:2], axis=0)  # lower minus upper: < 0 below the boundary
    if f >= 0.0 or a <= 0.0:
        return float("nan")
    return float((-c + np.sqrt(c * c - a * f)) / a)


def compare(products: Products) -> pd.DataFrame:
    """Compare the published numbers of some schemes with the numbers that a run reproduces.

    Return the rows of `published_numbers` for these schemes, with the further columns `reproduced`
    and `log2`, the base-2 logarithm of reproduced / published.
    """
    table = published_numbers()
    table = table[table.scheme.isin(list(products))].copy()
    keys = zip(table.scheme, table.natural_period, table.amplitude, table.measure, strict=True)
    table["reproduced"] = [
        float(at_amplitude(products[scheme][period][MEASURES.index(measure)], amplitude))
        for scheme, period, amplitude, measure in keys
    ]
    table["log2"] = np.log2(table.reproduced / table.published)
    return table.reset_index(drop=True)


def score(products: Products) -> tuple[float, Plain]:
    """Compute the score of a reading, less is better, from the products of its schemes.

    Without HME1 and HME2, the score is its first part alone. The details are `median_log2` and
    `p80_log2`, quantiles of |log2(reproduced / published)|. With HME1 and HME2 also `winners`, the
    schemes of least position MSE in the tables 6, 7, 8 and 9, and `boundary_4s`, `boundary_6s` and
    `boundary_8s`, m (NaN if there is none).
    """
    table = compare(products)
    logs = table.log2.abs()
    details: Plain = {"median_log2": float(logs.median()), "p80_log2": float(logs.quantile(0.8))}
    if not {*BOUNDED} <= {*products}:
        return float(logs.mean()), details
    position = table[table.measure.isin(["x", "y"])]
    sums = position.groupby(["table", "scheme"])[["published", "reproduced"]].sum().reset_index()
    published, winners = (
        list(sums.scheme[sums.groupby("table")[column].idxmin()])
        for column in ("published", "reproduced")
    )
    wrong = sum(a != b for a, b in zip(published, winners, strict=True))
    below, above = (products[scheme] for scheme in BOUNDED)
    limits = {period: boundary(below[period], above[period]) for period in (4.0, 6.0, 8.0)}
    parts = np.array([np.log2(limits[period] / target) for period, target in BOUNDARIES.items()])
    apart = float(np.sum(np.where(np.isfinite(parts), np.abs(parts), NO_BOUNDARY)))
    penalties = WINNER_PENALTY * wrong + BOUNDARY_WEIGHT * apart
    details["winners"] = " ".join(winners)
    details |= {f"boundary_{period:g}s": limit for period, limit in limits.items()}
    return float(logs.mean()) + penalties, details


def score_published(
    config: HubConfig, schemes: Sequence[str], lanes: Mapping[float, Lanes]
) -> tuple[float, Plain]:
    """Run the schemes on the records; return the score of the reading and its details."""
    return score({scheme: scheme_products(config, scheme, lanes) for scheme in schemes})


def score_settled(
    config: HubConfig, schemes: Sequence[str], lanes: Mapping[float, Lanes]
) -> tuple[float, Plain]:
    """Run the schemes on the records; return their settled position MSE, m^2, without details.

    It is the geometric mean over schemes, natural periods and the amplitudes of the grid.
    """
    settled = with_values(config, {"measures.window": "settled"})
    logs = [
        np.log(at_amplitude(products[:2].sum(axis=0), amplitude))
        for scheme in schemes
        for products in scheme_products(settled, scheme, lanes).values()
        for amplitude in config.grid.amplitude
    ]
    return float(np.exp(np.mean(logs))), {}
