"""Numeric tests of what Maes et al. (2018) say, and of what their printed numbers require.

Each test's docstring is the definition that the report prints. Thresholds were written down before
any record was judged. Intervals are over records.
"""

from __future__ import annotations

from collections.abc import Callable

from experiments.maes2018.processing import ROTATIONS, TRANSLATIONS
from owtsweep.verdicts.inference import Claim
from owtsweep.verdicts.scores import Scores

#: Statement -> what the paper says, in our words.
TEXTS = {
    "F1": "Figs. 9: longitudinal motions of root and centre of gravity are nearly the same",
    "F2": "Figs. 9 and 10: heading goes with the root's lateral motion, pitch with its vertical",
    "F3": "Figs. 9: lateral and vertical motion of the centre of gravity are very small",
    "F4": "Figs. 11 and 12: the differences of both systems are all of one order",
    "F5": "Figs. 11 and 12: rms differences are 10 to 21 mm and .070 to .115 deg",
    "F6": "Section 2.1: rms errors of the inertial system are 1 mm horizontally, 2 mm vertically",
    "F7": "Eqs. 4 to 11: Wahba's problem gives the attitude, and the formulas its angles",
    "F8": "Fig. 8: double integration shows the boom's vibration; slow motion is filtered away",
    "F9": "The inertial system depends on errors of the set-up only at the centre of gravity",
    "F10": "Not said: the heading is not observable in a record of 300 s; it must be given",
}
BOTH, NOISE = "both", "noise only"


def judge_f1(scores: Scores) -> list[Claim]:
    """Correlation at least .999, and rms difference below 5 % of the rms motion."""
    return [
        scores.claim("correlation", [(NOISE, "corr_u")], "above", 0.999),
        scores.claim("difference over rms", [(NOISE, "difference_u")], "below", 0.05),
    ]


def judge_f2(scores: Scores) -> list[Claim]:
    """Absolute correlations of at least .95."""
    places = [(NOISE, "corr_heading"), (NOISE, "corr_pitch")]
    return [scores.claim("correlation", places, "above", 0.95)]


def judge_f3(scores: Scores) -> list[Claim]:
    """Rms motions below half of the root's."""
    places = [(NOISE, "lateral"), (NOISE, "vertical")]
    return [scores.claim("over the root's", places, "below", 0.5)]


def judge_f4(scores: Scores) -> list[Claim]:
    """Of six translations, and of three rotations, the largest is at most 4 times the smallest.

    Printed: 2.1 and 1.65. With a clock that is .1 s late and a bent blade.
    """
    claims = []
    for words, names in (("translations", TRANSLATIONS), ("rotations", ROTATIONS)):
        pairs = [
            ((BOTH, f"difference_{a}"), (BOTH, f"difference_{b}"))
            for a in names
            for b in names
            if a != b
        ]
        claims.append(scores.claim_ratio(words, pairs, "below", 4.0))
    return claims


def judge_f5(scores: Scores) -> list[Claim]:
    """Differences with a late clock and a bent blade: 4 to 22 mm, .04 to .16 deg.

    Noise alone gives less than 10 mm and .10 deg, so the print needs more than noise.
    """
    far = [(BOTH, f"difference_{name}") for name in TRANSLATIONS]
    turned = [(BOTH, f"difference_{name}") for name in ROTATIONS]
    return [
        scores.claim("m", far, "above", 0.004),
        scores.claim("m", far, "below", 0.022),
        scores.claim("deg", turned, "above", 0.04),
        scores.claim("deg", turned, "below", 0.16),
        scores.claim(
            "noise alone, m", [(NOISE, f"difference_{n}") for n in TRANSLATIONS], "below", 0.010
        ),
        scores.claim(
            "noise alone, deg", [(NOISE, f"difference_{n}") for n in ROTATIONS], "below", 0.10
        ),
    ]


def judge_f6(scores: Scores) -> list[Claim]:
    """The smoothed root: at most 1.65 mm horizontally and 2.4 mm vertically, which rounds to print.

    Theory says 1.36 and 2.00 mm. In real time it is twice as much (goal G2).
    """
    level = [("filters", "SMOOTHER root_x"), ("filters", "SMOOTHER root_y")]
    return [
        scores.claim("horizontal, m", level, "below", 0.00165),
        scores.claim("vertical, m", [("filters", "SMOOTHER root_z")], "below", 0.0024),
    ]


def judge_f7(scores: Scores) -> list[Claim]:
    """Without noise exact to 1e-8, never a reflection; printed angles to 1e-12 away from 0."""
    return [
        scores.claim("pose", [("geometry", "pose")], "below", 1e-8),
        scores.claim("determinant - 1", [("geometry", "reflection")], "below", 1e-8),
        scores.claim("angles", [("geometry", "printed_angles")], "below", 1e-12),
    ]


def judge_f8(scores: Scores) -> list[Claim]:
    """Forward and reverse: error below .2 mm in the band; less than 1 % is left at .075 Hz."""
    return [
        scores.claim("error, mm", [("boom", "boom")], "below", 0.2),
        scores.claim("left at .075 Hz", [("boom", "slow_kept")], "below", 0.01),
    ]


def judge_f9(scores: Scores) -> list[Claim]:
    """A wrong place of the unit moves the centre of gravity by itself, and the root not at all.

    The root is where the unit is mounted: its distance is measured on the blade.
    """
    return [
        scores.claim("of the centre", [("geometry", "cog_over_lever")], "above", 0.999),
        scores.claim("of the centre", [("geometry", "cog_over_lever")], "below", 1.001),
        scores.claim("of the root", [("geometry", "root_over_lever")], "below", 1e-9),
    ]


def judge_f10(scores: Scores) -> list[Claim]:
    """The standard deviation of the heading at the end is at least .9 of that at the start."""
    return [scores.claim("end over start", [("filters", "heading_kept")], "above", 0.9)]


#: Statement -> its test.
STATEMENTS: dict[str, Callable[[Scores], list[Claim]]] = {
    "F1": judge_f1, "F2": judge_f2, "F3": judge_f3, "F4": judge_f4, "F5": judge_f5, "F6": judge_f6,
    "F7": judge_f7, "F8": judge_f8, "F9": judge_f9, "F10": judge_f10,
}  # fmt: skip
