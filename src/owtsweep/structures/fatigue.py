"""Fatigue of welds: rainflow counting, Goodman's correction, Miner's sum, equivalent ranges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.structures.sn_curves import SNCurve

#: Ultimate strength of S355 steel in Simpson et al. (2025), section 5.2.1, Pa.
ULTIMATE_STRENGTH = 5e8


@dataclass(frozen=True)
class Cycles:
    """The cycles of a history, counted by rainflow; three arrays of the same length.

    `ranges`, `means`: largest less smallest value of each cycle, above zero, and the middle between
    both, in the history's unit. `counts`: 1 for a closed cycle, 0.5 for one of the residue.
    """

    ranges: Array
    means: Array
    counts: Array


def count_cycles(history: Array) -> Cycles:
    """Count the cycles of a history, shape (steps,), by rainflow (ASTM E1049, section 5.4.4).

    Closed cycles are counted by the four-point method, and each range of the residue as half a
    cycle. The first and the last sample count as turning points. Nothing is binned or filtered.
    """
    # pylife brings pandas and takes a second to load.
    from pylife.stress.rainflow import FourPointDetector, LoopValueRecorder

    history = np.ascontiguousarray(history, dtype=float)  # a column of many is slow to read
    detector = FourPointDetector(LoopValueRecorder()).process(history)
    recorder, residue = detector.recorder, detector.residuals
    begin = np.concatenate([recorder.values_from, residue[:-1]])
    end = np.concatenate([recorder.values_to, residue[1:]])
    counts = np.ones(len(begin))
    counts[len(recorder.values_from) :] = 0.5
    ranges = np.abs(end - begin)
    real = ranges > 0.0  # a history may begin or end with equal samples
    return Cycles(ranges[real], (0.5 * (begin + end))[real], counts[real])


def correct_means(cycles: Cycles, ultimate_strength: float = ULTIMATE_STRENGTH) -> Array:
    """Return stress ranges of the same damage about a mean of zero, by Goodman (Eq. 32).

    S_0 = S / (1 - mean / ultimate strength), all in Pa, tension positive; a mean in compression
    shortens the range, as printed. Where the mean is at or above the ultimate strength, the
    corrected range is infinite: the weld breaks. That is no error, because the stress may be the
    estimate of a scheme that drifts away, and a damage without bound is then the right answer.
    """
    left = 1.0 - cycles.means / ultimate_strength
    ranges = np.full(len(left), np.inf)
    np.divide(cycles.ranges, left, out=ranges, where=left > 0.0)
    return ranges


def sum_damage(
    cycles: Cycles, curve: SNCurve, ultimate_strength: float = ULTIMATE_STRENGTH
) -> float:
    """Return Miner's damage of counted stress cycles (Eqs. 30-31); a weld fails at 1.

    Cycles are in Pa; so is `ultimate_strength`, which is infinite for no correction of means.
    """
    ranges = correct_means(cycles, ultimate_strength)
    return float(cycles.counts @ curve.spend(ranges))


def compute_damage(
    stress: Array,
    curves: SNCurve | Sequence[SNCurve],
    ultimate_strength: float = ULTIMATE_STRENGTH,
) -> Array:
    """Compute the fatigue damage of welds from their stress histories, without unit, (welds,).

    The damage is that of the histories' length: of 10 minutes for histories of 10 minutes. It is
    infinite for a weld whose mean stress in some cycle is at or above the ultimate strength (see
    `correct_means`).

    `stress`: stress in Pa, tension positive, shape (steps, welds). `curves`: one S-N curve for all
    welds, or one for each. `ultimate_strength`: for Goodman's correction, in Pa; infinite for none.
    """
    each = [curves] * stress.shape[1] if isinstance(curves, SNCurve) else curves
    damage = [
        sum_damage(count_cycles(history), curve, ultimate_strength)
        for history, curve in zip(stress.T, each, strict=True)
    ]
    return np.array(damage)


def find_equivalent_range(cycles: Cycles, m: float, reference_cycles: float) -> float:
    """Return the damage-equivalent range: (sum of count range^m / reference cycles)^(1/m).

    On an S-N curve of one branch with the exponent m, `reference_cycles` cycles of this range, e.g.
    600 for ten minutes at 1 Hz, do the same damage as the history. Means are left out. The result
    is in the unit of the ranges, and 0 for a constant history. For a load, it is called
    damage-equivalent load.
    """
    largest = float(cycles.ranges.max(initial=0.0))
    if largest == 0.0:
        return 0.0
    # Parts of the largest range: powers of moments in N m would overflow.
    total = float(cycles.counts @ (cycles.ranges / largest) ** m)
    return largest * float((total / reference_cycles) ** (1.0 / m))
