"""Numeric tests of what Mehammer et al. (2018) say about their results.

Each test's docstring is the definition that the report prints. Thresholds are those of the paper's
sentences, or of the project's notes before any record was judged. Intervals are over records.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from owtsweep.verdicts.inference import Claim
from owtsweep.verdicts.means import claim_means
from owtsweep.verdicts.scores import Scores

#: Degrees of freedom whose velocities figure 8 compares.
TRANSLATIONS = ("x", "y", "z")
PRINTED, TUNED = "decay, KF, R next to nothing", "decay, KF"
OBSERVER = "decay, PASSIVE_OBSERVER"


def judge_f1(scores: Scores) -> list[Claim]:
    """At 10 dB, of all samples at least 95 % have a relative error of surge below .15 %.

    Accelerations are exact and held, Q is next to nothing, and the filter begins at the truth.
    """
    return [scores.claim("share", [("noise 10 dB", "share_0.15")], "above", 0.95)]


def judge_f2(scores: Scores) -> list[Claim]:
    """As F1: no local maximum above .2 % where |x| is at least .1 of its standard deviation."""
    return [scores.claim("number of maxima", [("noise 10 dB", "peaks_away")], "below", 0.5)]


def judge_f3(scores: Scores) -> list[Claim]:
    """R ten times too large changes the rms error of surge by less than a factor of 1.4.

    At 20 dB: as in the paper, with process noise of 65 dB, whose wandering no filter can know; and
    with noisy accelerations in place of a wandering plant (KF_CONSISTENT).
    """
    return [
        scores.claim_ratio(
            words, [((wrong, "rms_x"), (right, "rms_x"))], "below", 1.4
        )
        for words, wrong, right in (
            ("as printed", "disturbed, R x 10", "disturbed, R right"),
            ("noisy accelerations", "20 dB, R x 10", "20 dB"),
        )
    ]  # fmt: skip


def judge_f4(scores: Scores) -> list[Claim]:
    """Delay of a step, no noise: the relative error of surge is below .5 % away from zero.

    Judged by its 99th percentile where |x| is at least .1 of its standard deviation. What a delay
    costs a filter that follows its reports is judged too: the rms error is what the motion travels
    in it, within 15 %.
    """
    delayed = "delay of a step"
    travel = [(delayed, "over_travel")]
    return [
        scores.claim("99th percentile, %", [(delayed, "relative_p99")], "below", 0.5),
        scores.claim("rms error over travel", travel, "above", 0.85),
        scores.claim("rms error over travel", travel, "below", 1.15),
    ]


def judge_f5(scores: Scores) -> list[Claim]:
    """Losses of .5 s as zeros at 100, 200, 300, 400 s; 20 dB, as printed; rms error of surge.

    With R x 1e20 in a loss (KF, the author's code) it is at most 1.05 of that without losses. The
    steady predictor is blind to them: the statement needs at most 1.05 there too.
    """
    return [
        scores.claim_ratio(
            scheme,
            [((f"losses as zeros, {scheme}", "rms_x"), (f"no loss, {scheme}", "rms_x"))],
            "below",
            1.05,
        )
        for scheme in ("KF", "KF_STEADY")
    ]


def judge_f6(scores: Scores) -> list[Claim]:
    """The rms errors of surge of KF_STEADY and KF differ by less than 2 % after 50 s.

    At 20 dB, and in the decay (with R next to nothing; after 2 s).
    """
    pairs = [
        (("no loss, KF_STEADY", "rms_x"), ("no loss, KF", "rms_x")),
        (("decay, KF_STEADY, R next to nothing", "rms_x"), (PRINTED, "rms_x")),
    ]
    text = "KF_STEADY over KF"
    return [
        scores.claim_ratio(text, pairs, "above", 0.98),
        scores.claim_ratio(text, pairs, "below", 1.02),
    ]


def judge_f7(scores: Scores) -> list[Claim]:
    """Decay: above 2 Hz, velocities of KF have less rms than those of the passive observer."""
    return [_compare(scores, words, name, "high") for words, name in _tunings()]


def judge_f8(scores: Scores) -> list[Claim]:
    """Decay: velocities of the passive observer are more than 50 ms later than those of KF.

    An observer that is not later counts as 0.
    """
    claims = []
    for words, name in _tunings():
        parts = []
        for dof in TRANSLATIONS:
            late, prompt = (scores.find((n, f"lag_velocity_{dof}")) for n in (OBSERVER, name))
            gap = None if late is None or prompt is None else np.maximum(late - prompt, 0.0)
            parts.append((f"{OBSERVER} - {name}, lag_velocity_{dof}", gap))
        claims.append(claim_means(f"ms later, {words}", parts, "above", 50.0))
    return claims


def judge_f9(scores: Scores) -> list[Claim]:
    """Decay: the rms errors of KF's velocities are below those of the passive observer."""
    return [_compare(scores, words, name, "velocity_rms") for words, name in _tunings()]


def judge_f10(scores: Scores) -> list[Claim]:
    """Surge differentiated twice and integrated by the kinematic model: no error above 1e-9 m.

    That SIMA's own accelerations do not integrate to its positions needs the author's file.
    """
    return [
        scores.claim("largest error, m", [("20 dB", "integrated")], "below", 1e-9),
        claim_means("SIMA's accelerations", [("needs the author's file", None)], "above", 1e-3),
    ]


def _tunings() -> list[tuple[str, str]]:
    """Return how KF may be tuned, in words, and the scenario of each."""
    return [("R next to nothing", PRINTED), ("R right", TUNED)]


def _compare(scores: Scores, words: str, name: str, measure: str) -> Claim:
    """Claim that a measure of KF is below that of the observer for all translations."""
    pairs = [((name, f"{measure}_{dof}"), (OBSERVER, f"{measure}_{dof}")) for dof in TRANSLATIONS]
    return scores.claim_ratio(f"KF over observer, {words}", pairs, "below", 1.0)


#: Statement -> its test.
STATEMENTS: dict[str, Callable[[Scores], list[Claim]]] = {
    "F1": judge_f1, "F2": judge_f2, "F3": judge_f3, "F4": judge_f4, "F5": judge_f5, "F6": judge_f6,
    "F7": judge_f7, "F8": judge_f8, "F9": judge_f9, "F10": judge_f10,
}  # fmt: skip
