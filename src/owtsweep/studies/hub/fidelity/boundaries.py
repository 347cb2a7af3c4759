"""The paper's claims about the HME1/HME2 boundary."""

from __future__ import annotations

from owtsweep.studies.hub.conditions import BOUNDARY
from owtsweep.studies.hub.fidelity.evidence import AMPLITUDES, HubEvidence, cells
from owtsweep.verdicts.claims import claim_estimate, claim_ratio
from owtsweep.verdicts.inference import Claim

#: Published boundaries: natural period (s) -> amplitude (m), section 5.3.
PUBLISHED = {4.0: 0.3, 6.0: 1.0}
#: A boundary read off a logarithmic axis is known to a factor of 2: the paper's own amplitudes
#: around it are .2 and .5 m at 4 s, .7 and 2 m at 6 s.
TOLERANCE = 2.0


def tolerated(period: float) -> tuple[float, float]:
    """The smallest and the largest amplitude (m) that agree with a published boundary."""
    return PUBLISHED[period] / TOLERANCE, PUBLISHED[period] * TOLERANCE


def claim_growth(evidence: HubEvidence) -> Claim:
    """The claim that the boundary grows with the period."""
    text, name = "the boundary at 8 s is above that at 4 s", "boundary at 4 s and 8 s"
    return claim_estimate(text, name, evidence.growth, {"above": 1.0})


def boundary_claims(evidence: HubEvidence, period: float) -> list[Claim]:
    """Claims at a period (s): the boundary within the tolerance, the better scheme outside it."""
    low, high = tolerated(period)
    boundary, name = evidence.boundaries.get(period), f"boundary at {period:g} s"
    text = f"the {name} lies in {low:g}-{high:g} m"
    below = cells([period], [a for a in AMPLITUDES if a < low])
    above = cells([period], [a for a in AMPLITUDES if a > high])
    lower, upper = BOUNDARY
    return [
        claim_estimate(text, name, boundary, {"above": low, "below": high}),
        claim_ratio(f"{lower} is better below {low:g} m", evidence, BOUNDARY, below, "below"),
        claim_ratio(f"{upper} is better above {high:g} m", evidence, BOUNDARY, above, "above"),
    ]
