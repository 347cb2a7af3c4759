"""F9 and F11: numeric tests of the paper's statements about the time histories at 3.8 s.

As in `fidelity.statements`, the docstrings are the definitions and were written before judging.
"""

from __future__ import annotations

from collections.abc import Callable

from owtsweep.studies.hub.fidelity.evidence import Evidence
from owtsweep.studies.hub.fidelity.history_errors import SCHEMES
from owtsweep.verdicts.inference import Claim, mean_ratio

#: The share of samples that must be within a bound: "within" is read as 95 % of them, not all.
SHARE_INSIDE = 0.95
LACKING = ("time histories of HME1 and HME2 at 3.8 s",)


def f9(evidence: Evidence) -> list[Claim]:
    """Share of the settled samples of vx and vy with an error of at most 0.05 m/s, at 3.8 s.

    Above 95 % for HME1 and for HME2, on the mean over the records (t test). Settled is what follows
    `measures.settling_time`. Amplitude 0.5 m: section 5.2 does not print it; it finds HME1 better
    in position, so by Fig. 15 it lies above 0.3 m, and 0.5 m is the next one of the paper's.
    """
    text = "95 % of the velocity errors of HME1 and HME2 are within 0.05 m/s"
    if evidence.history_errors is None:
        return [Claim(text, (), LACKING)]
    decisions = tuple(
        mean_ratio(f"3.8 s, 0.5 m: {name}", inside, 1.0, SHARE_INSIDE, "above")
        for name, inside in evidence.history_errors.inside.items()
    )
    return [Claim(text, decisions)]


def f11(evidence: Evidence) -> list[Claim]:
    """Accumulated absolute error over the whole record, x and y together, at 3.8 s and 0.5 m.

    (a) HME1 / HME2 of the position is below 1; (b) HME2 / HME1 of the velocity and (c) of the bias
    estimate are below 1; "slightly" is not tested. The amplitude is that of F9.
    """
    hme1, hme2 = SCHEMES
    claims = [
        ("HME1 is better in position", "position", hme1, hme2),
        ("HME2 is better in velocity", "velocity", hme2, hme1),
        ("HME2 is better in bias", "bias", hme2, hme1),
    ]
    if evidence.history_errors is None:
        return [Claim(text, (), LACKING) for text, *_ in claims]
    sums = evidence.history_errors.accumulated
    return [
        Claim(
            text,
            (
                mean_ratio(
                    f"3.8 s, 0.5 m: {first} / {second}, {quantity}",
                    sums[first, quantity],
                    sums[second, quantity],
                    1.0,
                    "below",
                ),
            ),
        )
        for text, quantity, first, second in claims
    ]


#: Statements that need time histories.
HISTORY_STATEMENTS: dict[str, Callable[[Evidence], list[Claim]]] = {"F9": f9, "F11": f11}
