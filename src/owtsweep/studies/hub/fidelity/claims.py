"""Claims that several statements make: a scheme wins everywhere, a boundary lies in a range."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.studies.hub.fidelity.boundaries import boundary_at, within
from owtsweep.studies.hub.fidelity.evidence import AMPLITUDES, Cell, Evidence, cells
from owtsweep.verdicts.inference import Claim, Comparison, Side, mean_ratio

#: A boundary read off a logarithmic axis is known to a factor of 2: the paper's own amplitudes
#: around it are .2 and .5 m at 4 s, .7 and 2 m at 6 s.
BOUNDARY_TOLERANCE = 2.0


def against_best(
    text: str, evidence: Evidence, scheme: str, where: Sequence[Cell], side: Side
) -> Claim:
    """A scheme over the best of the paper's others, against 1 in all the cells."""
    comparisons: list[Comparison] = []
    missing: list[str] = []
    for cell in where:
        found = evidence.best_other(scheme, cell)
        if found is None:
            missing.append(str(cell))
        else:
            name, own, other = found
            comparisons.append(mean_ratio(f"{cell}: {scheme} / {name}", own, other, 1.0, side))
    return Claim(text, tuple(comparisons), tuple(missing))


def all_cells(
    text: str,
    evidence: Evidence,
    schemes: tuple[str, str],
    where: Sequence[Cell],
    side: Side,
    *,
    measure: str = "position",
) -> Claim:
    """The first scheme over the second, against 1 in all the cells."""
    first, second = schemes
    comparisons: list[Comparison] = []
    missing: list[str] = []
    for cell in where:
        found = evidence.paired(schemes, cell, measure)
        if found is None:
            missing.append(str(cell))
        else:
            label = f"{cell}: {first} / {second}"
            comparisons.append(mean_ratio(label, found[first], found[second], 1.0, side))
    return Claim(text, tuple(comparisons), tuple(missing))


def boundary_claims(evidence: Evidence, period: float, printed: float) -> list[Claim]:
    """The boundary at a period (s) within the tolerance, and the better scheme outside of it."""
    low, high = printed / BOUNDARY_TOLERANCE, printed * BOUNDARY_TOLERANCE
    found = boundary_at(evidence, period)
    below = cells([period], [a for a in AMPLITUDES if a < low])
    above = cells([period], [a for a in AMPLITUDES if a > high])
    pair = ("HME2", "HME1")
    return [
        Claim(
            f"the boundary at {period:g} s lies in {low:g}-{high:g} m",
            () if found is None else within(found, low, high),
            (f"boundary at {period:g} s",) if found is None else (),
        ),
        all_cells(f"HME2 is better below {low:g} m", evidence, pair, below, "below"),
        all_cells(f"HME1 is better above {high:g} m", evidence, pair, above, "above"),
    ]
