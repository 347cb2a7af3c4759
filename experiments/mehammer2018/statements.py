"""Numeric tests of what Mehammer et al. (2018) say about their results.

Each test's docstring is the definition that the report prints. Thresholds are those of the paper's
sentences, or of the project's notes before any record was judged. Intervals are over records. The
author's record of the buoy is one record: its numbers are compared as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from experiments.mehammer2018.published import read_author_record
from owtsweep.arrays import Array
from owtsweep.statistics.contrasts import gap
from owtsweep.verdicts.claims import gather
from owtsweep.verdicts.inference import Claim, Decision, Estimate, Side
from owtsweep.verdicts.means import claim_means
from owtsweep.verdicts.scores import Scores

#: Degrees of freedom whose velocities figure 8 compares.
TRANSLATIONS = ("x", "y", "z")
PRINTED, TUNED = "decay, KF, R next to nothing", "decay, KF"
OBSERVER = "decay, PASSIVE_OBSERVER"


def judge_f1(scores: Scores) -> list[Claim]:
    """At 10 dB, more than half of all samples have a relative error of surge below .15 %.

    The paper says "throughout most of the simulation", and no share: most is more than half.
    Accelerations are exact and held, Q is next to nothing, and the filter begins at the truth.
    """
    return [scores.claim("share", [("noise 10 dB", "share_0.15")], "above", 0.5)]


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

    Of KF, with R x 1e20 in a loss as in the author's code, it is at most 1.05 of that without
    losses. KF_STEADY is not judged: "the time-varying version has to be used" (section 3.1).
    """
    pair = ("losses as zeros, KF", "rms_x"), ("no loss, KF", "rms_x")
    return [scores.claim_ratio("KF", [pair], "below", 1.05)]


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
    """Above 2 Hz, velocities of KF have less rms than those of the passive observer.

    In the decay here, and in the author's record.
    """
    return [*_compare(scores, "high"), _compare_in_record("high")]


def judge_f8(scores: Scores) -> list[Claim]:
    """Velocities of the passive observer are later than those of KF.

    By however little: the paper says no time. In the decay here, and in the author's record.
    """
    claims = []
    for words, name in _tunings():
        parts: list[tuple[str, Decision | None]] = []
        for dof in TRANSLATIONS:
            late, prompt = (scores.find((n, f"lag_velocity_{dof}")) for n in (OBSERVER, name))
            label = f"{OBSERVER} - {name}, lag_velocity_{dof}"
            if late is None or prompt is None:
                parts.append((label, None))
                continue
            parts.append((label, _decide_positive(label, late - prompt)))
        claims.append(gather(f"ms later, {words}", parts))
    record = _find_record()
    gaps = [
        (f"lag_{dof}, observer - KF", record["lag", "OBSERVER", dof] - record["lag", "KF", dof])
        for dof in TRANSLATIONS
    ]
    return [*claims, _claim_exactly("ms later, author's record", gaps, "above", 0.0)]


def judge_f9(scores: Scores) -> list[Claim]:
    """The rms errors of KF's velocities are below those of the passive observer.

    In the decay here, and in the author's record, with the zero-phase derivative of the measured
    position as truth.
    """
    return [*_compare(scores, "velocity_rms"), _compare_in_record("velocity_rms")]


def judge_f10(scores: Scores) -> list[Claim]:
    """Surge differentiated twice and integrated by the kinematic model: no error above 1e-9 m.

    Whether SIMA's own accelerations integrate to its positions needs the author's file (reference
    [12]), which has no licence and is not kept here.
    """
    return [
        scores.claim("largest error, m", [("20 dB", "integrated")], "below", 1e-9),
        claim_means("SIMA's accelerations", [("needs the author's file", None)], "above", 1e-3),
    ]


def _tunings() -> list[tuple[str, str]]:
    """Return how KF may be tuned, in words, and the scenario of each."""
    return [("R next to nothing", PRINTED), ("R right", TUNED)]


def _compare(scores: Scores, measure: str) -> list[Claim]:
    """Claim that a measure of KF, tuned in two ways, is below the observer's in the decay here."""
    claims = []
    for words, name in _tunings():
        pairs = [
            ((name, f"{measure}_{dof}"), (OBSERVER, f"{measure}_{dof}")) for dof in TRANSLATIONS
        ]
        claims.append(scores.claim_ratio(f"KF over observer, {words}", pairs, "below", 1.0))
    return claims


def _compare_in_record(measure: str) -> Claim:
    """Claim that a measure of KF is below the observer's in the author's record."""
    record = _find_record()
    ratios = [
        (f"{measure}_{dof}", record[measure, "KF", dof] / record[measure, "OBSERVER", dof])
        for dof in TRANSLATIONS
    ]
    return _claim_exactly("KF over observer, author's record", ratios, "below", 1.0)


def _decide_positive(label: str, values: Array) -> Decision:
    """Decide by the t test whether the mean of values of any sign is above 0."""
    found = gap(values)
    mean, low, high = float(found.value), float(found.low), float(found.high)
    error = float(np.std(values, ddof=1) / np.sqrt(len(values))) if len(values) > 1 else np.inf
    with np.errstate(divide="ignore", invalid="ignore"):  # equal values have no error
        t = float(np.nan_to_num(np.divide(mean, error), posinf=np.inf, neginf=-np.inf))
    return Decision(label, mean, low, high, 0.0, "above", t, float(found.p))


def _claim_exactly(
    text: str, places: Iterable[tuple[str, float]], side: Side, threshold: float
) -> Claim:
    """Claim that numbers of one record, which have no interval, lie on a side of a threshold.

    The number that is furthest from holding comes first.
    """
    ordered = sorted(places, key=lambda place: place[1], reverse=side == "below")
    numbers = [Estimate(f"{label}, one record", value, value, value) for label, value in ordered]
    return Claim(text, tuple(number.against(threshold, side) for number in numbers))


def _find_record() -> dict[tuple[str, str, str], float]:
    """Return (measure, estimate, state) -> what the author's record says."""
    table = read_author_record()
    keys = zip(table["measure"], table["estimate"], table["state"], strict=True)
    return dict(zip(keys, table["value"].astype(float), strict=True))


#: Statement -> its test.
STATEMENTS: dict[str, Callable[[Scores], list[Claim]]] = {
    "F1": judge_f1, "F2": judge_f2, "F3": judge_f3, "F4": judge_f4, "F5": judge_f5, "F6": judge_f6,
    "F7": judge_f7, "F8": judge_f8, "F9": judge_f9, "F10": judge_f10,
}  # fmt: skip
