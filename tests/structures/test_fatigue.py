"""Rainflow counts by hand and by a plain second implementation; damage in closed form."""

import subprocess
import sys
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from owtsweep.structures.fatigue import (
    ULTIMATE_STRENGTH,
    Cycles,
    compute_damage,
    correct_means,
    count_cycles,
    find_equivalent_range,
    sum_damage,
)
from owtsweep.structures.sn_curves import SNCurve, find_curve

#: The series of ASTM E1049, figure 6.
ASTM = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])


def tell(cycles: Cycles) -> dict[tuple[float, float], float]:
    """Return (range, mean) -> number of cycles."""
    told: Counter[tuple[float, float]] = Counter()
    for size, mean, count in zip(cycles.ranges, cycles.means, cycles.counts, strict=True):
        told[float(size), float(mean)] += float(count)
    return dict(told)


def count_plainly(history: np.ndarray) -> dict[tuple[float, float], float]:
    """Count by the three-point rules of ASTM E1049, 5.4.4, one after the other."""
    turns: list[float] = []
    for value in history.tolist():
        if turns and value == turns[-1]:
            continue
        if len(turns) > 1 and (turns[-1] > turns[-2]) == (value > turns[-1]):
            turns[-1] = value
        else:
            turns.append(value)
    told: Counter[tuple[float, float]] = Counter()

    def add(a: float, b: float, count: float) -> None:
        told[abs(b - a), 0.5 * (a + b)] += count

    stack: list[float] = []
    for turn in turns:
        stack.append(turn)
        while len(stack) >= 3:
            first, second, third = stack[-3:]
            if abs(third - second) < abs(second - first):
                break
            if len(stack) == 3:  # the range holds the starting point
                add(first, second, 0.5)
                del stack[0]
            else:
                add(first, second, 1.0)
                del stack[-3:-1]
    for a, b in pairwise(stack):
        add(a, b, 0.5)
    return dict(told)


def test_the_series_of_the_standard_is_counted_as_by_hand():
    by_hand = {
        (3.0, -0.5): 0.5,  # -2 to 1
        (4.0, -1.0): 0.5,  # 1 to -3
        (8.0, 1.0): 0.5,  # -3 to 5
        (4.0, 1.0): 1.0,  # -1 to 3
        (9.0, 0.5): 0.5,  # 5 to -4
        (8.0, 0.0): 0.5,  # -4 to 4
        (6.0, 1.0): 0.5,  # 4 to -2
    }
    assert tell(count_cycles(ASTM)) == by_hand
    assert count_plainly(ASTM) == by_hand


@pytest.mark.parametrize("levels", [3, 8, None])
def test_counts_agree_with_a_plain_implementation(levels):
    random = np.random.default_rng(5)
    for length in [*range(1, 12), 50, 400, 3000]:
        history = random.normal(size=length).cumsum() + random.normal(size=length)
        if levels is not None:  # plateaus and equal turning points
            history = random.integers(levels, size=length).astype(float)
        got, plain = tell(count_cycles(history)), count_plainly(history)
        assert got == plain, history


def test_damage_of_the_standards_series_by_hand():
    curve = SNCurve((3.0,), (12.0,))
    total = 0.5 * 27 + 0.5 * 64 + 0.5 * 512 + 64 + 0.5 * 729 + 0.5 * 512 + 0.5 * 216
    damage = compute_damage(10e6 * ASTM[:, None], curve, np.inf)
    np.testing.assert_allclose(damage, 1000.0 * total / 1e12, rtol=1e-12)


@pytest.mark.parametrize(
    ("amplitude", "spent"),
    [(8e6, 16.0**5 / 10.0**15.606), (90e6, 180.0**3 / 10.0**12.164)],
    ids=["second branch", "first branch"],
)
def test_damage_of_a_sine_in_closed_form(amplitude, spent):
    periods, per_period = 60, 40
    phase = 2.0 * np.pi * np.arange(periods * per_period + 1) / per_period
    cosine = amplitude * np.cos(phase)  # begins and ends at a peak
    assert compute_damage(cosine[:, None], find_curve("D")) == pytest.approx(
        periods * spent, rel=1e-12
    )
    # about a mean, by Goodman: every range grows by 1 / (1 - mean / strength)
    mean, strength = 100e6, 400e6
    corrected = sum_damage(count_cycles(cosine + mean), find_curve("paper"), strength)
    line = 10.0**-13.617 * (2e-6 * amplitude / 0.75) ** 5
    assert corrected == pytest.approx(periods * line, rel=1e-12)


def test_both_branches_go_into_one_sum():
    curve = find_curve("D", "seawater")
    ranges = np.array([30e6, 150e6])
    cycles = Cycles(ranges, np.zeros(2), np.array([100.0, 2.5]))
    expected = 100.0 * 30.0**5 / 10.0**15.606 + 2.5 * 150.0**3 / 10.0**11.764
    assert sum_damage(cycles, curve) == pytest.approx(expected, rel=1e-12)


def test_goodman_in_tension_compression_and_beyond_the_strength():
    means = np.array([0.0, 250e6, -250e6, 499.999e6, 500e6, 600e6])
    cycles = Cycles(np.full(6, 10e6), means, np.ones(6))
    got = correct_means(cycles)
    np.testing.assert_allclose(got[:4], [10e6, 20e6, 10e6 / 1.5, 5e12], rtol=1e-6)
    assert np.isinf(got[4:]).all()
    assert sum_damage(cycles, find_curve("D")) == np.inf
    runaway = np.array([[0.0, 0.0], [1e80, 1e6], [0.0, 0.0]])  # an estimate that diverged
    damage = compute_damage(runaway, find_curve("paper"))
    assert damage[0] == np.inf
    assert 0.0 < damage[1] < 1.0
    assert ULTIMATE_STRENGTH == 500e6


def test_many_welds_equal_one_after_the_other():
    random = np.random.default_rng(6)
    stress = 5e6 * random.normal(size=(2000, 3)).cumsum(axis=0)
    stress -= stress.mean(axis=0)
    curves = [find_curve("D"), find_curve("E", "seawater"), find_curve("paper")]
    damage = compute_damage(stress, curves)
    for weld, curve in enumerate(curves):
        assert damage[weld] == sum_damage(count_cycles(stress[:, weld].copy()), curve)
    # in the order of time or against it, and scaled: the power law of one branch
    for factor in (-1.0, 0.5, 3.0):
        scaled = compute_damage(factor * stress, find_curve("paper"), np.inf)
        expected = abs(factor) ** 5 * compute_damage(stress, find_curve("paper"), np.inf)
        np.testing.assert_allclose(scaled, expected, rtol=1e-12)


def test_the_equivalent_range_does_the_histories_damage():
    random = np.random.default_rng(7)
    cycles = count_cycles(10e6 * random.normal(size=3000))
    for m in (3.0, 5.0, 10.0):
        equal = find_equivalent_range(cycles, m, 600.0)
        curve = SNCurve((m,), (13.0,))
        same = Cycles(np.array([equal]), np.zeros(1), np.array([600.0]))
        assert sum_damage(same, curve) == pytest.approx(sum_damage(cycles, curve, np.inf))
        # of a moment in N m, whose power would overflow
        large = Cycles(cycles.ranges * 1e40, cycles.means, cycles.counts)
        assert find_equivalent_range(large, m, 600.0) == pytest.approx(1e40 * equal)
    sine = Cycles(np.full(600, 4e6), np.zeros(600), np.ones(600))
    assert find_equivalent_range(sine, 4.0, 600.0) == pytest.approx(4e6)


def test_a_constant_history_does_no_damage():
    constant = np.full((500, 2), 3e7)
    assert (compute_damage(constant, find_curve("D")) == 0.0).all()
    assert find_equivalent_range(count_cycles(constant[:, 0]), 5.0, 600.0) == 0.0


def test_pylife_waits_until_cycles_are_counted():
    code = "import sys, owtsweep.structures.fatigue; print('pylife' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60.0
    )
    assert done.stdout.strip() == "False"
