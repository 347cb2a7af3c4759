"""The HME1/HME2 boundary of a run, as the statements and the report need it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.errors import InputError
from owtsweep.studies.hub.fidelity.evidence import DIGITS, Evidence
from owtsweep.studies.hub.fidelity.inference import Comparison, Side, interval

#: HME2 has the lesser position MSE below the boundary, HME1 above it.
LOWER, UPPER = "HME2", "HME1"


@dataclass(frozen=True)
class Boundary:
    """An amplitude (m), or a ratio of two, with its 95 % bootstrap interval over the replicates.

    NaN where one scheme is better at every amplitude.
    """

    label: str
    value: float
    low: float
    high: float

    def against(self, threshold: float, side: Side) -> Comparison:
        """Against a threshold; undecided where there is no boundary."""
        return interval(self.label, self.value, self.low, self.high, threshold, side)


def boundary_at(evidence: Evidence, natural_period: float) -> Boundary | None:
    """The boundary at one period (s); None where the run lacks a scheme or the period."""
    from owtsweep.studies.hub.boundary import boundary

    if not _has(evidence, natural_period):
        return None
    try:
        table = boundary(evidence.rows, lower=LOWER, upper=UPPER, window=evidence.window)
    except InputError:  # cases run directly have no products to find a root of
        return None
    found = table[np.round(table["natural_period"].astype(float), DIGITS) == natural_period]
    if not len(found):
        return None
    row = found.iloc[0]
    label = f"boundary at {natural_period:g} s"
    return Boundary(label, float(row.boundary), float(row.ci_low), float(row.ci_high))


def ratio_of_boundaries(evidence: Evidence, period: float, to: float) -> Boundary | None:
    """The boundary at one period over that at another (s); None where either is missing."""
    from owtsweep.studies.hub.boundary import boundary_ratio

    if not (_has(evidence, period) and _has(evidence, to)):
        return None
    try:
        ratio = boundary_ratio(
            evidence.rows, period, to, lower=LOWER, upper=UPPER, window=evidence.window
        )
    except InputError:
        return None
    return Boundary(f"boundary at {period:g} s over that at {to:g} s", *map(float, ratio))


def within(boundary: Boundary, low: float, high: float) -> tuple[Comparison, ...]:
    """The claim that a boundary lies in a range."""
    return boundary.against(low, "above"), boundary.against(high, "below")


def _has(evidence: Evidence, period: float) -> bool:
    rows = evidence.finished
    here = rows[(np.round(rows["natural_period"].astype(float), DIGITS) == period)]
    return {LOWER, UPPER} <= set(here["scheme"])
