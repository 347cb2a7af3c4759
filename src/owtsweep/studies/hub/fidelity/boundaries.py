"""The HME1/HME2 boundary of a run, and the paper's claims about it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.studies.hub.conditions import BOUNDARY, CONDITIONS
from owtsweep.studies.hub.fidelity.evidence import AMPLITUDES, Evidence, cells
from owtsweep.verdicts.claims import claim_ratio
from owtsweep.verdicts.evidence import DIGITS
from owtsweep.verdicts.inference import Claim, Decision, Side, interval

if TYPE_CHECKING:
    import pandas as pd

#: HME2 has the smaller position MSE below the boundary, HME1 above it.
LOWER, UPPER = BOUNDARY
MEASURE = "position"
#: Published boundaries: natural period (s) -> amplitude (m), section 5.3.
PUBLISHED = {4.0: 0.3, 6.0: 1.0}
#: A boundary read off a logarithmic axis is known to a factor of 2: the paper's own amplitudes
#: around it are .2 and .5 m at 4 s, .7 and 2 m at 6 s.
TOLERANCE = 2.0


@dataclass(frozen=True)
class Boundary:
    """An amplitude (m), or a ratio of two, with its 95 % bootstrap interval over the replicates.

    NaN where there is none; `wins` is then the scheme that is better at every amplitude, or
    "neither".
    """

    label: str
    value: float
    low: float
    high: float
    wins: str = ""

    def against(self, threshold: float, side: Side) -> Decision:
        """Compare the boundary with a threshold; undecided where there is no boundary."""
        return interval(self.label, self.value, self.low, self.high, threshold, side)


def boundary_at(evidence: Evidence, natural_period: float) -> Boundary | None:
    """The boundary at one period (s); None where the run lacks a scheme or the period."""
    from owtsweep.results.boundary import find_boundary

    rows = _rows(evidence, natural_period)
    if rows is None:
        return None
    try:
        row = find_boundary(rows, CONDITIONS, BOUNDARY, MEASURE, evidence.window).iloc[0]
    except InputError:  # cases run directly have no products, so a boundary cannot be computed
        return None
    label = f"boundary at {natural_period:g} s"
    if row.wins == "neither":
        label += " (none: the means cross twice, or the other way round)"
    elif row.wins:
        label += f" (none: {row.wins} is better at every amplitude)"
    return Boundary(label, float(row.boundary), float(row.ci_low), float(row.ci_high), row.wins)


def ratio_of_boundaries(evidence: Evidence, period: float, to: float) -> Boundary | None:
    """The boundary at one period over that at another (s); None where either is missing."""
    from owtsweep.results.boundary import find_boundary_ratio

    rows = _rows(evidence, period, to)
    if rows is None:
        return None
    try:
        cells = (period,), (to,)
        ratio = find_boundary_ratio(rows, CONDITIONS, cells, BOUNDARY, MEASURE, evidence.window)
    except InputError:
        return None
    return Boundary(f"boundary at {period:g} s over that at {to:g} s", *ratio)


def all_boundaries(evidence: Evidence) -> dict[float, Boundary]:
    """Natural period (s) -> boundary, for the run's periods that have both schemes."""
    periods = map(float, evidence.grid["natural_period"])
    boundaries = {period: boundary_at(evidence, period) for period in sorted(periods)}
    return {period: item for period, item in boundaries.items() if item is not None}


def tolerated(period: float) -> tuple[float, float]:
    """The smallest and the largest amplitude (m) that agree with a published boundary."""
    return PUBLISHED[period] / TOLERANCE, PUBLISHED[period] * TOLERANCE


def claim_within(text: str, boundary: Boundary | None, period: float) -> Claim:
    """The claim that the boundary at a period (s) lies within the tolerance."""
    if boundary is None:
        return Claim(text, (), (f"boundary at {period:g} s",))
    low, high = tolerated(period)
    return Claim(text, (boundary.against(low, "above"), boundary.against(high, "below")))


def boundary_claims(evidence: Evidence, period: float) -> list[Claim]:
    """Claims at a period (s): the boundary within the tolerance, the better scheme outside it."""
    low, high = tolerated(period)
    below = cells([period], [a for a in AMPLITUDES if a < low])
    above = cells([period], [a for a in AMPLITUDES if a > high])
    text = f"the boundary at {period:g} s lies in {low:g}-{high:g} m"
    pair = (LOWER, UPPER)
    return [
        claim_within(text, boundary_at(evidence, period), period),
        claim_ratio(f"{LOWER} is better below {low:g} m", evidence, pair, below, "below"),
        claim_ratio(f"{UPPER} is better above {high:g} m", evidence, pair, above, "above"),
    ]


def _rows(evidence: Evidence, *periods: float) -> pd.DataFrame | None:
    """The cases of both schemes at these periods, or None if one scheme has none."""
    finished = evidence.finished
    exact = finished["natural_period"].astype(float).round(DIGITS)
    chosen = finished["scheme"].isin(BOUNDARY) & exact.isin(periods)
    present = set(zip(finished["scheme"][chosen], exact[chosen], strict=True))
    return finished[chosen] if set(product(BOUNDARY, periods)) <= present else None
