"""Numeric goals of the project for the blade study's estimators, beside the paper's statements.

The paper's system, every scheme told the truth, no outage unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Callable

from experiments.maes2018.scores import ALIKE
from owtsweep.verdicts.inference import Claim
from owtsweep.verdicts.scores import Place, Scores

#: Goal -> what is to be reached.
TEXTS = {
    "G1": "UKF: NIS over 3 in .95 to 1.05, rms error over the root of P in .9 to 1.1 per axis",
    "G2": "UKF: rms error 2.5 to 3.3 mm horizontally and 3.6 to 4.6 mm vertically",
    "G3": "UKF, MEKF and INVARIANT_EKF within 2 %",
    "G4": "coasting through 10 s grows as P says within 10 %",
    "G5": "total stations: the offset of their clock is found within 10 ms",
    "G6": "double integration: within .2 mm, forward and reverse",
}


def _of(scheme: str, measures: tuple[str, ...]) -> list[Place]:
    return [("filters", f"{scheme} {measure}") for measure in measures]


def judge_g1(scores: Scores) -> list[Claim]:
    """Means over records."""
    ratios = _of("UKF", ("rms_over_p_x", "rms_over_p_y", "rms_over_p_z"))
    return [
        scores.claim("NIS", _of("UKF", ("nis",)), "above", 0.95),
        scores.claim("NIS", _of("UKF", ("nis",)), "below", 1.05),
        scores.claim("rms over root of P", ratios, "above", 0.9),
        scores.claim("rms over root of P", ratios, "below", 1.1),
    ]


def judge_g2(scores: Scores) -> list[Claim]:
    """Of the root, 2 m from the inertial unit."""
    level, upright = _of("UKF", ("root_x", "root_y")), _of("UKF", ("root_z",))
    return [
        scores.claim("horizontal, m", level, "above", 0.0025),
        scores.claim("horizontal, m", level, "below", 0.0033),
        scores.claim("vertical, m", upright, "above", 0.0036),
        scores.claim("vertical, m", upright, "below", 0.0046),
    ]


def judge_g3(scores: Scores) -> list[Claim]:
    """Ratios of rms errors of root, velocity and attitude to those of UKF."""
    pairs = [
        (("filters", f"{name} {measure}"), ("filters", f"UKF {measure}"))
        for name in ALIKE[1:]
        for measure in ("root", "velocity", "attitude")
    ]
    return [
        scores.claim_ratio("over UKF", pairs, "above", 0.98),
        scores.claim_ratio("over UKF", pairs, "below", 1.02),
    ]


def judge_g4(scores: Scores) -> list[Claim]:
    """Outages of 10 s every 30 s: errors of UKF at their ends over the root of P."""
    place = [("coasting", "end_over_p")]
    return [
        scores.claim("over root of P", place, "above", 0.9),
        scores.claim("over root of P", place, "below", 1.1),
    ]


def judge_g5(scores: Scores) -> list[Claim]:
    """By correlating altitudes, without an offset and with .1 s; means over records."""
    places = [("noise only", "offset_error"), ("late clock", "offset_error")]
    return [scores.claim("error, s", places, "below", 0.010)]


def judge_g6(scores: Scores) -> list[Claim]:
    """The tip of the study's boom, all three directions: rms error in space, mean over records."""
    return [scores.claim("error, mm", [("boom", "boom")], "below", 0.2)]


#: Goal -> its test.
GOALS: dict[str, Callable[[Scores], list[Claim]]] = {
    "G1": judge_g1, "G2": judge_g2, "G3": judge_g3, "G4": judge_g4, "G5": judge_g5, "G6": judge_g6,
}  # fmt: skip
