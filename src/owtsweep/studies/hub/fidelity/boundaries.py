"""Test claims of Ren et al. (2019) on the amplitude at which HME1 and HME2 are equally good."""

from __future__ import annotations

from owtsweep.studies.hub.conditions import BOUNDARY
from owtsweep.studies.hub.fidelity.evidence import AMPLITUDES, HubEvidence, cells
from owtsweep.verdicts.claims import claim_estimate, claim_ratio
from owtsweep.verdicts.inference import Claim

#: Published boundaries, section 5.3 of the paper: natural period (s) -> amplitude (m).
PUBLISHED = {4.0: 0.3, 6.0: 1.0}
#: A published boundary is known to a factor of 2, because it is read off a logarithmic axis: the
#: paper's amplitudes on either side of the boundary are 0.2 and 0.5 m at 4 s, 0.7 and 2 m at 6 s.
TOLERANCE = 2.0


def tolerated(period: float) -> tuple[float, float]:
    """Return the least and greatest amplitude (m) that agree with the published boundary.

    The boundary is the amplitude at which HME1 and HME2 are equally good. `period` is a natural
    period at which a boundary is published: 4 or 6 s.
    """
    return PUBLISHED[period] / TOLERANCE, PUBLISHED[period] * TOLERANCE


def claim_growth(evidence: HubEvidence) -> Claim:
    """Test the claim that the boundary between HME1 and HME2 grows with the natural period.

    The boundary is the amplitude at which both schemes are equally good. The claim is that this
    amplitude is larger at 8 s than at 4 s. `evidence` holds the results of the run.
    """
    text, name = "the boundary at 8 s is above that at 4 s", "boundary at 4 s and 8 s"
    return claim_estimate(text, name, evidence.growth, {"above": 1.0})


def boundary_claims(evidence: HubEvidence, period: float) -> list[Claim]:
    """Test three claims on the boundary between HME1 and HME2 at a natural period of 4 or 6 s.

    First, the boundary lies within a factor of 2 of the published amplitude. Second, HME2 has the
    smaller position MSE at all amplitudes below this range. Third, HME1 has the smaller position
    MSE at all amplitudes above this range. `evidence` holds the results of the run.
    """
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
