"""What is measured of estimates: damage of welds, interface loads, motion.

Names of measures end with the direction, "fa" or "ss". Signals are judged after
`record.settling`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.signals import (
    compute_frac,
    compute_mae,
    compute_trac,
    divide_by_deviation,
    find_lag,
    scatter,
)
from owtsweep.results.criteria import Criterion
from owtsweep.structures.fatigue import compute_damage, count_cycles, find_equivalent_range
from owtsweep.studies.base.schemes import NotFinite
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS, Channel, Estimates, Kind
from owtsweep.studies.tower.setting import Substructure
from owtsweep.studies.tower.truth import Motion

#: Criteria of the maps.
_PART = "a hundredth of the signal itself changes no decision"
CRITERIA = {
    "damage": Criterion(
        "damage: |log2 of estimated over true| at the worst weld", "plain", "doublings", 0.05,
        ".05 doublings are 3.5 % of damage, far below the scatter of S-N curves",
    ),
    "base_moment": Criterion(
        "base moment: std of its error over its own std, fore-aft", "root", "", 0.01, _PART
    ),
    "displacement": Criterion(
        "displacement: std of its error over its own std, worst node", "root", "", 0.01, _PART
    ),
}  # fmt: skip
#: Heights above the ground (m) at which displacement and rotation are compared (Table 3).
LEVELS = (0.0, 15.0)
#: Welds count for `damage` if their true damage is more than this part of the largest.
COUNTS = 0.01
#: Exponent of damage-equivalent loads, as is usual for steel, and their cycles per second.
EXPONENT, CYCLE_RATE = 4.0, 1.0
#: |log2| of a damage ratio is at most this: zero and infinite damage must not spoil means.
MOST_DOUBLINGS = 60.0
#: Kind of a sensor -> the measure that holds its smallest noise.
QUIETEST: dict[Kind, str] = {"theta": "noise_theta", "a": "noise_a"}


@dataclass(frozen=True)
class Fatigue:
    """What the cycles of one direction do.

    damage: Damage of each weld over the judged part of the record, shape (nodes,).
    loads: Damage-equivalent loads of `INPUTS` in N and N m, shape (4,): the ranges which, once per
        second, do the damage of the record on an S-N curve with the exponent `EXPONENT`.
    """

    damage: Array
    loads: Array


def find_fatigue(
    config: TowerConfig, heights: Array, moved: Motion | Estimates, stress: Array
) -> Fatigue:
    """Compute what the cycles of one direction of a record do, or those of its estimates.

    `heights` of the nodes are above mean sea level, in m; `stress` is in Pa for unit degrees of
    freedom, shape (nodes, dof).
    """
    settled = slice(config.record.settled, None)
    curves = config.fatigue.find_curves(heights)
    history = moved.displacement[settled] @ stress.T
    cycles = CYCLE_RATE * len(history) / config.record.rate
    loads = [
        find_equivalent_range(count_cycles(column), EXPONENT, cycles)
        for column in moved.inputs[settled].T
    ]
    damage = compute_damage(history, curves, config.fatigue.ultimate_strength)
    return Fatigue(damage, np.array(loads))


def compare(
    config: TowerConfig,
    part: Substructure,
    motions: Mapping[str, Motion],
    true_fatigue: Mapping[str, Fatigue],
    estimates: Mapping[str, Estimates],
) -> dict[str, float]:
    """Compare estimates of a record, by direction, with its truth; return measure -> value.

    `part` is the substructure as the scheme models it. Raise `NotFinite` if an estimate is not
    finite.
    """
    settled, heights = slice(config.record.settled, None), config.nodes
    found: dict[str, float] = {}
    doublings, counting, worst = [], [], 0.0
    for direction in DIRECTIONS:
        estimate, motion = estimates[direction], motions[direction]
        moved, loads = estimate.displacement[settled], estimate.inputs[settled]
        if not (np.isfinite(moved).all() and np.isfinite(loads).all()):
            raise NotFinite("the estimate is not finite")
        true_moved, true_loads = motion.displacement[settled], motion.inputs[settled]
        true = true_fatigue[direction]
        fatigue = find_fatigue(config, part.cut.heights, estimate, part.stress)
        ratio = _count_doublings(fatigue.damage, true.damage)
        doublings.append(ratio)
        counting.append(true.damage)
        own = {}
        for name, load, of_truth in zip(INPUTS, fatigue.loads, true.loads, strict=True):
            own[f"equivalent_{name}"] = load
            if of_truth > 0.0:
                own[f"equivalent_ratio_{name}"] = load / of_truth
        for z, damage, by in zip(heights, fatigue.damage, ratio, strict=True):
            own[f"damage_{name_height(z)}"] = damage
            own[f"damage_ratio_{name_height(z)}"] = by
        error = scatter(true_moved[:, ::2], moved[:, ::2])
        worst = max(worst, float(np.nanmax(error)))
        if direction == DIRECTIONS[0]:
            moment = INPUTS.index("M0")
            found["base_moment"] = float(scatter(true_loads[:, moment], loads[:, moment]))
        own |= _compare_signals(config.record.rate, heights, true_moved, moved, true_loads, loads)
        if estimate.wave is not None and np.any(motion.wave):
            own["trac_wave"] = compute_trac(motion.wave[settled], estimate.wave[settled])
        found |= {f"{name}_{direction}": float(value) for name, value in own.items()}
    damages, ratios = np.concatenate(counting), np.concatenate(doublings)
    found["damage"] = float(np.abs(ratios[damages > COUNTS * damages.max()]).max(initial=0.0))
    found["displacement"] = worst
    return found


def _compare_signals(
    rate: float, heights: Array, true_moved: Array, moved: Array, true_loads: Array, loads: Array
) -> dict[str, Array]:
    """Return TRAC, FRAC and MAE of motion at `LEVELS` and of loads, and the lag of loads."""
    names, columns = [], []
    for level in LEVELS:
        for node in np.flatnonzero(np.abs(heights - level) <= 1e-6):
            names += [f"x{level:g}", f"theta{level:g}"]
            columns += [2 * node, 2 * node + 1]
    true = np.column_stack([true_moved[:, columns], true_loads])
    estimate = np.column_stack([moved[:, columns], loads])
    mae = compute_mae(true, estimate)
    values = {
        "trac": compute_trac(true, estimate),
        "trac_centred": compute_trac(true, estimate, centred=True),
        "frac": compute_frac(true, estimate),
        "mae": mae,
        "mae_sigma": divide_by_deviation(mae, true),
    }
    found = {
        f"{measure}_{name}": value
        for measure, each in values.items()
        for name, value in zip([*names, *INPUTS], each, strict=True)
    }
    lags = find_lag(true_loads, loads, 1.0 / rate)
    return found | {f"lag_{name}": lag for name, lag in zip(INPUTS, lags, strict=True)}


def find_quietest(channels: Sequence[Channel]) -> dict[str, float]:
    """Return the least noise per sample of inclinometers (rad) and of accelerometers (m/s^2).

    Keys are those of `QUIETEST`; a kind that no channel of the direction has is left out.
    """
    noises = {
        name: [channel.sigma for channel in channels if channel.kind == kind]
        for kind, name in QUIETEST.items()
    }
    return {name: min(each) for name, each in noises.items() if each}


def name_height(height: float) -> str:
    """Return a height above the ground in names of measures, e.g. "z058" for 58 m."""
    return f"z{height:03.0f}" if height == round(height) else f"z{height:g}"


def _count_doublings(damage: Array, true: Array) -> Array:
    """Return log2 of damage over true damage, within +-`MOST_DOUBLINGS`."""
    with np.errstate(divide="ignore", invalid="ignore"):  # of welds without stress
        ratio = np.log2(damage) - np.log2(true)
    ratio = np.where((damage == 0.0) & (true == 0.0), 0.0, ratio)
    return np.asarray(np.clip(ratio, -MOST_DOUBLINGS, MOST_DOUBLINGS))
