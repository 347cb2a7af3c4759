"""What is measured of estimates: damage of welds, interface loads, motion.

Names of measures end with the direction, "fa" or "ss". Signals are judged after
`record.settling`.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.signals import (
    compute_frac,
    compute_mae,
    compute_trac,
    divide_by_deviation,
    find_lag,
)
from owtsweep.structures.fatigue import compute_damage
from owtsweep.studies.tower.case import Case
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS, Estimates

#: Criteria of the maps -> what the title of a map says.
CRITERIA = {
    "damage": "damage: |log2 of estimated over true| at the worst weld",
    "base_moment": "base moment: std of its error over its own std, fore-aft",
    "displacement": "displacement: std of its error over its own std, worst node",
}
#: The only window: after the settling time.
WINDOW = "settled"
#: Heights above the ground (m) at which displacement and rotation are compared (Table 3).
LEVELS = (0.0, 15.0)
#: Welds count for `damage` if their true damage is more than this part of the largest.
COUNTS = 0.01
#: |log2| of a damage ratio is at most this: zero and infinite damage must not spoil means.
MOST_DOUBLINGS = 60.0
#: Longest lag that is looked for, s.
LONGEST_LAG = 5.0


def find_true_damage(config: TowerConfig, case: Case) -> dict[str, Array]:
    """Compute the true damage of all welds, direction -> (nodes,)."""
    return {
        direction: _damage(config, case, case.motion[direction].displacement, case.true_stress)
        for direction in DIRECTIONS
    }


def compare(
    config: TowerConfig,
    case: Case,
    true_damage: dict[str, Array],
    estimates: dict[str, Estimates],
) -> dict[str, float]:
    """Compare the estimates of a record with its truth; return measure -> value.

    `true_damage` and `estimates` are by direction.

    Raises
    ------
    ValueError
        If an estimate is not finite.
    """
    settled = slice(config.record.settled, None)
    found: dict[str, float] = {}
    doublings, counting, worst = [], [], 0.0
    for direction in DIRECTIONS:
        estimate, motion = estimates[direction], case.motion[direction]
        moved, loads = estimate.displacement[settled], estimate.inputs[settled]
        if not (np.isfinite(moved).all() and np.isfinite(loads).all()):
            raise ValueError("the estimate is not finite")
        true_moved, true_loads = motion.displacement[settled], motion.inputs[settled]
        damage = _damage(config, case, estimate.displacement, case.part.stress)
        ratio = _count_doublings(damage, true_damage[direction])
        doublings.append(ratio)
        counting.append(true_damage[direction])
        for z, own, by in zip(_heights(case), damage, ratio, strict=True):
            found[f"damage_{name_height(z)}_{direction}"] = float(own)
            found[f"damage_ratio_{name_height(z)}_{direction}"] = float(by)
        error = _scatter(true_moved[:, ::2], moved[:, ::2])
        worst = max(worst, float(np.nanmax(error)))
        if direction == DIRECTIONS[0]:
            moment = INPUTS.index("M0")
            found["base_moment"] = float(_scatter(true_loads[:, moment], loads[:, moment]))
        found |= _compare_signals(config, case, direction, true_moved, moved, true_loads, loads)
        if estimate.wave is not None and np.any(motion.wave):
            of_wave = compute_trac(motion.wave[settled], estimate.wave[settled])
            found[f"trac_wave_{direction}"] = float(of_wave)
    true, ratios = np.concatenate(counting), np.concatenate(doublings)
    found["damage"] = float(np.abs(ratios[true > COUNTS * true.max()]).max(initial=0.0))
    found["displacement"] = worst
    return found


def _scatter(truth: Array, estimate: Array) -> Array:
    """Return the standard deviation of the error over that of the truth, of each column.

    The mean error does not count: in the field the zero of an inclinometer is not known, and
    fatigue needs the changes. A drift counts. (The measures `mae` keep the mean.)
    """
    return divide_by_deviation(np.std(estimate - truth, axis=0), truth)


def _compare_signals(
    config: TowerConfig,
    case: Case,
    direction: str,
    true_moved: Array,
    moved: Array,
    true_loads: Array,
    loads: Array,
) -> dict[str, float]:
    """Return TRAC, FRAC and MAE of motion at `LEVELS` and of loads, and the lag of loads."""
    heights = _heights(case)
    names, columns = [], []
    for level in LEVELS:
        for node in np.flatnonzero(np.abs(heights - level) <= 1e-6):
            names += [f"x{level:g}", f"theta{level:g}"]
            columns += [2 * node, 2 * node + 1]
    true = np.column_stack([true_moved[:, columns], true_loads])
    estimate = np.column_stack([moved[:, columns], loads])
    mae = compute_mae(true, estimate)
    longest = min(LONGEST_LAG, 0.2 * len(true) / config.record.rate)
    values = {
        "trac": compute_trac(true, estimate),
        "trac_centred": compute_trac(true, estimate, centred=True),
        "frac": compute_frac(true, estimate),
        "mae": mae,
        "mae_sigma": divide_by_deviation(mae, true),
    }
    found = {
        f"{measure}_{name}_{direction}": float(value)
        for measure, each in values.items()
        for name, value in zip([*names, *INPUTS], each, strict=True)
    }
    lags = find_lag(true_loads, loads, 1.0 / config.record.rate, longest)
    return found | {
        f"lag_{name}_{direction}": float(lag) for name, lag in zip(INPUTS, lags, strict=True)
    }


def list_measures(names: Iterable[str]) -> list[str]:
    """Return measures in the order of tables: criteria first, then by name."""
    return [*CRITERIA, *sorted(set(names) - {*CRITERIA, ""})]


def name_height(height: float) -> str:
    """Return a height above the ground in names of measures, e.g. "z058" for 58 m."""
    return f"z{height:03.0f}" if height == round(height) else f"z{height:g}"


def _heights(case: Case) -> Array:
    """Return the heights of the nodes above the ground, m."""
    return np.asarray(case.part.cut.heights - case.part.structure.mudline)


def _damage(config: TowerConfig, case: Case, displacement: Array, stress: Array) -> Array:
    """Compute the damage of each node's weld over the settled part of a record."""
    curves = config.fatigue.find_curves(case.part.cut.heights)
    history = displacement[config.record.settled :] @ stress.T
    return compute_damage(history, curves, config.fatigue.ultimate_strength)


def _count_doublings(damage: Array, true: Array) -> Array:
    """Return log2 of damage over true damage, within +-`MOST_DOUBLINGS`."""
    with np.errstate(divide="ignore", invalid="ignore"):  # of welds without stress
        ratio = np.log2(damage) - np.log2(true)
    ratio = np.where((damage == 0.0) & (true == 0.0), 0.0, ratio)
    return np.asarray(np.clip(ratio, -MOST_DOUBLINGS, MOST_DOUBLINGS))
