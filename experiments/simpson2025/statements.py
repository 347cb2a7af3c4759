"""Numeric tests of what Simpson et al. (2025) say about their results.

Each test's docstring is the definition that the report prints. Definitions and thresholds are those
of the project's notes before any record was judged. TRAC and FRAC are judged by their distance from
1, so "TRAC at least .9995" reads "1 - TRAC below 5e-4". MAE / sigma divides by the standard
deviation of the true signal. Intervals are over records.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from experiments.simpson2025.claims import (
    Place,
    below_one,
    claim,
    claim_difference,
    claim_ratio,
    everywhere,
    invert,
)
from experiments.simpson2025.evidence import Scores
from experiments.simpson2025.scenarios import ACCELEROMETERS, GNSS, WAVES, WEIGHTLESS, WIND
from owtsweep.studies.tower.contract import INPUTS
from owtsweep.verdicts.inference import Claim

#: States that the paper compares, by kind.
ROTATIONS, DISPLACEMENTS = ("theta0", "theta15"), ("x0", "x15")


def judge_f1(scores: Scores) -> list[Claim]:
    """1 - TRAC below 5e-4 for theta0 and theta15, both directions, all set-ups, wind only."""
    places = everywhere(WIND.values(), ROTATIONS)
    return [claim("1 - TRAC of rotations", scores, places, "trac", "below", 5e-4, of=below_one)]


def judge_f2(scores: Scores) -> list[Claim]:
    """1 - TRAC below 5e-4 for x0 and x15, both directions, Dense: x-a, wind only."""
    places = everywhere([WIND["dense_x_a"]], DISPLACEMENTS)
    return [claim("1 - TRAC of displacements", scores, places, "trac", "below", 5e-4, of=below_one)]


def judge_f3(scores: Scores) -> list[Claim]:
    """Set-up Dense: θ-a, wind only, modal coordinates of mass-normalised modes.

    The rms error of the worst normal or attachment mode is less than .01 of that of the worst rigid
    mode; 1 - TRAC of the worst normal or attachment mode is below 1e-3.
    """
    places = everywhere([WIND["dense_theta_a"]], ["modes"])
    pairs = [(place, place) for place in places]
    errors = ("other_error", "rigid_error")
    return [
        claim_ratio("error of other over rigid modes", scores, pairs, errors, "below", 0.01),
        claim("1 - TRAC of other modes", scores, places, "least_trac", "below", 1e-3, of=below_one),
    ]


def judge_f4(scores: Scores) -> list[Claim]:
    """Set-ups without displacement sensors, wind only: TRAC over FRAC of x0, x15 below 1."""
    drifting = [WIND["dense_theta_a"], WIND["sparse_theta_a"]]
    pairs = [(place, place) for place in everywhere(drifting, DISPLACEMENTS)]
    return [claim_ratio("TRAC / FRAC", scores, pairs, ("trac", "frac"), "below", 1.0)]


def judge_f5(scores: Scores) -> list[Claim]:
    """Wind only, all set-ups, each direction: worst deviation of damage below 15 %.

    The worst deviation of a record is the largest |estimated / true - 1| over the nodes with more
    than 1 % of the direction's largest damage; its mean over the records is judged.
    """
    places = everywhere(WIND.values(), ["welds"])
    return [claim("worst deviation of damage", scores, places, "worst_deviation", "below", 0.15)]


def judge_f6(scores: Scores) -> list[Claim]:
    """Wind only: TRAC of each input differs by less than .01 between the dense set-ups."""
    first, second = (everywhere([WIND[setup]], INPUTS) for setup in ("dense_x_a", "dense_theta_a"))
    pairs = zip(first, second, strict=True)
    return [claim_difference("difference of TRAC", scores, pairs, "trac", 0.01)]


def judge_f7(scores: Scores) -> list[Claim]:
    """Wind only. MAE of F0 and M0 with Sparse: θ-a more than twice that with Dense: θ-a.

    The lag of F0 fore-aft is above 50 ms with Sparse: θ-a and below 10 ms with Dense: θ-a. As the
    offset from p-delta (F8) is in the MAE, it is judged in records without gravity too.
    """
    ground = ("F0", "M0")
    claims = []
    for words, world in (("with gravity", WIND), ("without gravity", WEIGHTLESS)):
        sparse = everywhere([world["sparse_theta_a"]], ground)
        dense = everywhere([world["dense_theta_a"]], ground)
        pairs = list(zip(sparse, dense, strict=True))
        text = f"MAE of sparse over dense, {words}"
        claims.append(claim_ratio(text, scores, pairs, ("mae", "mae"), "above", 2.0))
    late, prompt = (
        Place(WIND["sparse_theta_a"], "fa", "F0"),
        Place(WIND["dense_theta_a"], "fa", "F0"),
    )
    return [
        *claims,
        claim("lag (s), sparse", scores, [late], "lag", "above", 0.05, of=np.abs),
        claim("lag (s), dense", scores, [prompt], "lag", "below", 0.01, of=np.abs),
    ]


def judge_f8(scores: Scores) -> list[Claim]:
    """Set-up Dense: θ-a, wind only, fore-aft.

    The mean error of F175 without gravity is less than .1 of that with. MAE of theta0 and
    theta15 with gravity is less than 1.05 times that without, and so is the damage ratio at the
    ground.
    """
    heavy, light = WIND["dense_theta_a"], WEIGHTLESS["dense_theta_a"]
    offset = [(Place(light, "fa", "F175"), Place(heavy, "fa", "F175"))]
    states = [(Place(heavy, "fa", q), Place(light, "fa", q)) for q in ROTATIONS]
    ground = [(Place(heavy, "fa", "z=0"), Place(light, "fa", "z=0"))]
    ratios = ("damage_ratio", "damage_ratio")
    return [
        claim_ratio(
            "offset of F175, without over with", scores, offset, ("offset",) * 2, "below", 0.1
        ),
        claim_ratio("MAE of rotations", scores, states, ("mae", "mae"), "below", 1.05),
        claim_ratio("damage ratio at the ground", scores, ground, ratios, "below", 1.05),
    ]


def judge_f9(scores: Scores) -> list[Claim]:
    """Sparse: θ-a, waves along the wind. Estimated over true damage at the ground, fore-aft.

    It is below .6 with p_1, and between .75 and 1.25 with p_2. Side-side it differs by less than
    .02 between p_1 and p_2.
    """
    first, second = (Place(WAVES[0, inputs], "ss", "z=0") for inputs in ("p_1", "p_2"))
    return [
        *_judge_ground(scores, 0, "fa", 0.6),
        claim_difference(
            "damage ratio side-side, p_1 - p_2", scores, [(first, second)], "damage_ratio", 0.02
        ),
    ]


def judge_f10(scores: Scores) -> list[Claim]:
    """Sparse: θ-a, waves 30 degrees from the wind. Estimated over true damage, ground, side-side.

    It is below .7 with p_1, and between .75 and 1.25 with p_2.
    """
    return _judge_ground(scores, 30, "ss", 0.7)


def judge_f11(scores: Scores) -> list[Claim]:
    """Sparse: θ-a, waves along the wind, p_1, fore-aft; spectra (Welch) from .13 to .20 Hz.

    The amplitude of F0 and M0 in this band, estimated over true, is below .9; the frequency of the
    peak differs by less than .005 Hz. TRAC of F175 and M175 differs by less than .05 from that in
    case study 1, with p_1 and p_2.
    """
    without = WAVES[0, "p_1"]
    places = [Place(without, "fa", name) for name in ("F0", "M0")]
    pairs = [
        (Place(WAVES[0, inputs], "fa", name), Place(WIND["sparse_theta_a"], "fa", name))
        for inputs in ("p_1", "p_2")
        for name in INPUTS[2:]
    ]
    return [
        claim("amplitude ratio at the first mode", scores, places, "mode_ratio", "below", 0.9),
        claim("shift of the peak (Hz)", scores, places, "mode_shift", "below", 0.005),
        claim_difference("difference of TRAC at the top", scores, pairs, "trac", 0.05),
    ]


def judge_f12(scores: Scores) -> list[Claim]:
    """Sparse: θ-a and one GNSS receiver at the nacelle, wind only, both directions.

    The sensors see all states and inputs of a direction (PBH test), but miss two without the
    receiver: position and velocity of the rigid translation. The rms error of x0 in the last 100 s
    is less than twice that in the first 100 s judged, and less than .1 of that without it.
    """
    with_gnss = everywhere([GNSS], ["x0"])
    without = everywhere([WIND["sparse_theta_a"]], ["x0"])
    same = [(place, place) for place in with_gnss]
    ends, late = ("late_error", "early_error"), ("late_error", "late_error")
    whole = everywhere([GNSS], ["filter"])
    part = everywhere([WIND["sparse_theta_a"]], ["filter"])
    pairs = list(zip(with_gnss, without, strict=True))
    return [
        claim("unseen directions, with GNSS", scores, whole, "unseen", "below", 0.5),
        claim("unseen directions, without", scores, part, "unseen", "above", 1.5),
        claim_ratio("late over early error of x0", scores, same, ends, "below", 2.0),
        claim_ratio("late error over that without GNSS", scores, pairs, late, "below", 0.1),
    ]


def judge_f13(scores: Scores) -> list[Claim]:
    """The accelerometers of Sparse: θ-a alone, wind only, both directions.

    The damage of the worst node is wrong by more than a factor of 2, either way: the inverse of the
    factor is below .5.
    """
    places = everywhere([ACCELEROMETERS], ["welds"])
    text = "1 / factor of the worst damage"
    return [claim(text, scores, places, "worst_factor", "below", 0.5, of=invert)]


def judge_f14(scores: Scores) -> list[Claim]:
    """Computing time per sample at 100 Hz below 1 ms, with all three set-ups, per direction."""
    places = everywhere(WIND.values(), ["filter"])
    text = "seconds per sample"
    return [claim(text, scores, places, "seconds_per_step", "below", 1e-3)]


def _judge_ground(scores: Scores, yaw: int, direction: str, limit: float) -> list[Claim]:
    """Claim that p_1 underestimates the damage at the ground, and p_2 does not."""
    without, with_waves = (
        [Place(WAVES[yaw, inputs], direction, "z=0")] for inputs in ("p_1", "p_2")
    )
    measure = "damage_ratio"
    return [
        claim("damage ratio, p_1", scores, without, measure, "below", limit),
        claim("damage ratio, p_2", scores, with_waves, measure, "above", 0.75),
        claim("damage ratio, p_2", scores, with_waves, measure, "below", 1.25),
    ]


#: Statement -> its test.
STATEMENTS: dict[str, Callable[[Scores], list[Claim]]] = {
    "F1": judge_f1, "F2": judge_f2, "F3": judge_f3, "F4": judge_f4, "F5": judge_f5, "F6": judge_f6,
    "F7": judge_f7, "F8": judge_f8, "F9": judge_f9, "F10": judge_f10, "F11": judge_f11,
    "F12": judge_f12, "F13": judge_f13, "F14": judge_f14,
}  # fmt: skip
