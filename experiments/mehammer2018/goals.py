"""Numeric goals of the project for the floater study's estimators, beside the paper's statements.

Every scheme is told the truth (tuning matched); positions, rates and accelerations have white noise
of one signal-to-noise ratio, 20 dB unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from experiments.mehammer2018.cells import CONSISTENT, PLANES, RIVALS
from owtsweep.arrays import Array
from owtsweep.studies.floater.contract import DOF
from owtsweep.verdicts.inference import Claim
from owtsweep.verdicts.scores import Place, Scores

#: Goal -> what is to be reached.
TEXTS = {
    "G1": "rms position error within 10 % of the root of P, at 10 and 20 dB, every degree of "
    "freedom",
    "G2": "and at most .12 of a report's noise where the motion is slow enough",
    "G3": "mean NEES over its dimension in .95 to 1.05",
    "G4": "time-varying within 2 % of steady-state after 50 s",
    "G5": "a believed R ten times too large costs at most 1.4 in rms",
    "G6": "an uncompensated delay without noise costs what the closed loop says, within 5 %",
    "G7": "a delay compensated exactly costs what the prediction's own P says, within 5 %",
    "G8": "four losses of .5 s: known at most 1.05, as zeros at least 4 where the mean is 2.5 "
    "standard deviations",
    "G9": "error-state filter: within 2 % of the linear one at .5 deg of roll, better by a factor "
    "of 2 at 20 deg",
    "G10": "velocity: the consistent filter beats passive observer and differentiation in every "
    "cell of the default maps",
}
#: A motion is slow enough from this period on, in s (at 20 Hz).
SLOW = 31.0


def judge_g1(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT: rms error over the root of the mean variance, between .9 and 1.1."""
    places = [(name, f"rms_over_p_{dof}") for name in ("10 dB", "20 dB") for dof in DOF]
    return [
        scores.claim("rms over root of P", places, "above", 0.9),
        scores.claim("rms over root of P", places, "below", 1.1),
    ]


def judge_g2(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT, positions that no rate helps: surge and sway, without waves.

    They count where 2 pi over the root of acceleration over position (standard deviations) is 31 s
    or more. At 10 dB the same holds: both noises scale alike.
    """
    slow = []
    for name in ("20 dB, slow", "10 dB, slow"):
        for dof in ("x", "y", "z"):
            period = scores.find((name, f"period_{dof}"))
            if period is not None and period.mean() >= SLOW:
                slow.append((name, f"noise_ratio_{dof}"))
    return [scores.claim("rms error over noise", slow or [("slow", "none")], "below", 0.12)]


def judge_g3(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT at 10 and 20 dB, over all degrees of freedom."""
    places = [(name, "nees") for name in ("10 dB", "20 dB")]
    return [
        scores.claim("NEES", places, "above", 0.95),
        scores.claim("NEES", places, "below", 1.05),
    ]


def judge_g4(scores: Scores) -> list[Claim]:
    """Rms error of KF_STEADY over that of KF, every degree of freedom."""
    pairs = [(("20 dB, KF_STEADY", f"rms_{dof}"), ("20 dB, KF", f"rms_{dof}")) for dof in DOF]
    return [
        scores.claim_ratio("KF_STEADY over KF", pairs, "above", 0.98),
        scores.claim_ratio("KF_STEADY over KF", pairs, "below", 1.02),
    ]


def judge_g5(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT, rms error of the position, every degree of freedom."""
    pairs = [(("20 dB, R x 10", f"rms_{dof}"), ("20 dB", f"rms_{dof}")) for dof in DOF]
    return [scores.claim_ratio("R x 10 over R", pairs, "below", 1.4)]


def judge_g6(scores: Scores) -> list[Claim]:
    """KF_STEADY with the gain of 20 dB, delay of four steps, surge; measured over predicted."""
    places = [("delay of 4, KF_STEADY", "over_closed_loop")]
    return [
        scores.claim("rms error over closed loop", places, "above", 0.95),
        scores.claim("rms error over closed loop", places, "below", 1.05),
    ]


def judge_g7(scores: Scores) -> list[Claim]:
    """KF_DELAY, delay of four steps: rms error over the root of its P, which has the prediction."""
    places = [("delay of 4, KF_DELAY", f"rms_over_p_{dof}") for dof in DOF]
    return [
        scores.claim("rms over root of P", places, "above", 0.95),
        scores.claim("rms over root of P", places, "below", 1.05),
    ]


def judge_g8(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT, surge with a mean of 2.5 standard deviations; rms error over the record."""
    whole = ("far", "rms_x")
    known, zeros = (("far, losses known", "rms_x"), ("far, losses as zeros", "rms_x"))
    return [
        scores.claim_ratio("known over none", [(known, whole)], "below", 1.05),
        scores.claim_ratio("as zeros over none", [(zeros, whole)], "above", 4.0),
    ]


def judge_g9(scores: Scores) -> list[Claim]:
    """Sensors fixed to the body, 20 dB: ERROR_STATE over the linear filter KF_CONSISTENT.

    Rms error of the position over its standard deviation, all degrees of freedom. At 20 deg the
    linear filter takes gravity away to first order of the angles. With the full rotation by the
    reported attitude it bears large angles too: there it is judged to be no better.
    """
    small, large, turned = (
        ((f"roll {roll} deg, ERROR_STATE", "position"), (f"roll {roll} deg, {linear}", "position"))
        for roll, linear in ((0.5, "KF_CONSISTENT"), (20, "first order"), (20, "KF_CONSISTENT"))
    )
    return [
        scores.claim_ratio("full rotation, 20 deg", [turned], "below", 1.0),
        scores.claim_ratio("at .5 deg", [small], "above", 0.98),
        scores.claim_ratio("at .5 deg", [small], "below", 1.02),
        scores.claim_ratio("at 20 deg", [large], "below", 0.5),
    ]


def judge_g10(scores: Scores) -> list[Claim]:
    """KF_CONSISTENT over its rivals, each as well tuned as noise and motion allow.

    "At equal lag" is more than needed: the consistent filter has none.
    """
    claims = []
    for plane in PLANES:
        pairs: list[tuple[Place, Place]] = [
            ((name, f"velocity_{CONSISTENT}"), (name, f"velocity_{rival}"))
            for name in scores.list_scenarios(f"{plane}: ")
            for rival in RIVALS
        ]
        claims.append(scores.claim_ratio(plane, pairs, "below", 1.0))
    return claims


def list_lost_cells(scores: Scores) -> list[str]:
    """Return the cells in which a rival's mean velocity error is not above the consistent one's."""

    def mean(name: str, scheme: str) -> float:
        values: Array | None = scores.find((name, f"velocity_{scheme}"))
        return np.nan if values is None else float(values.mean())

    return [
        f"{name} ({rival} {mean(name, rival):.3f}, {CONSISTENT} {mean(name, CONSISTENT):.3f})"
        for plane in PLANES
        for name in scores.list_scenarios(f"{plane}: ")
        for rival in RIVALS
        if mean(name, rival) <= mean(name, CONSISTENT)
    ]


#: Goal -> its test.
GOALS: dict[str, Callable[[Scores], list[Claim]]] = {
    "G1": judge_g1, "G2": judge_g2, "G3": judge_g3, "G4": judge_g4, "G5": judge_g5, "G6": judge_g6,
    "G7": judge_g7, "G8": judge_g8, "G9": judge_g9, "G10": judge_g10,
}  # fmt: skip
