"""The crane's boom: how its tip vibrates, what accelerometers on it say, and who knows it.

The tip moves in modes, each along a line in space, and follows the blade's swing by a part: the
load bends the boom. The lines of both are at the same frequencies, so displacements and
accelerations are exact derivatives of each other at the accelerometers' own rate.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import RATE, decimate, integrate_twice, pass_high
from owtsweep.evaluation.measures import compute_rms_length
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import draw_lines, find_frequencies, respond, sample
from owtsweep.streams import Streams
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import Accelerations, BoomMotion

#: Seconds at both ends of a record in which filters that run in both directions are less exact.
ENDS = 20.0


def make_boom(config: BladeConfig, draws: Streams, swing: NDArray[np.complex128]) -> BoomMotion:
    """Return the motion of the boom's tip in a record.

    Each mode has a random stream of its own. `swing` holds complex amplitudes of the translations
    of the blade's centre of gravity in m, at the multiples of 1 / (twice the record), shape (lines,
    3).
    """
    boom, record = config.boom, config.record
    steps = round(record.steps * boom.rate / record.rate)
    frequency = find_frequencies(steps, 1.0 / boom.rate)
    lines = np.zeros((len(frequency), 3), dtype=complex)
    shared = min(len(swing), len(lines)) - 1  # the last line of either is not sampled
    lines[:shared] = np.array(boom.follow) * swing[:shared]
    for name, mode in boom.modes.items():
        density = respond(frequency, mode.period, mode.damping)
        lines += draw_lines(density, draws(f"boom_{name}")) * np.array(mode.sigma)
    series = sample(lines, steps, 1.0 / boom.rate, 0)
    return BoomMotion(boom.rate, series.position, series.acceleration)


def measure_boom(config: BladeConfig, draws: Streams, motion: BoomMotion) -> Accelerations:
    """Return what the accelerometers on the boom's tip say: with gravity, a bias and noise."""
    bias = config.boom.bias * draws("boom_bias").standard_normal(3)
    noise = config.boom.noise * draws("boom_noise").standard_normal(motion.acceleration.shape)
    felt = motion.acceleration + bias + noise + np.array([0.0, 0.0, GRAVITY])
    return Accelerations(motion.rate, felt)


def estimate_boom(felt: Accelerations, *, zero_phase: bool = True) -> Array:
    """Return the displacement of the boom's tip above .15 Hz, m, at 20 Hz, shape (n, 3).

    By the chain of Maes et al. (2018), Fig. 8. With `zero_phase`, the high-pass filter runs in both
    directions. In one, what passes it leads. Raise `InputError` if the rate is no whole multiple of
    20 Hz, or the record is not longer than 10 s.
    """
    moved = integrate_twice(decimate(felt.values, felt.rate), RATE)
    return pass_high(moved, RATE, zero_phase=zero_phase)


def find_boom_error(motion: BoomMotion, estimate: Array, settled: float) -> float | None:
    """Return the rms error in space of a boom's displacement above .15 Hz at 20 Hz, m.

    The truth passes the same filter in both directions. The first `settled` seconds, and 20 s at
    both ends, are not judged; None if nothing is left.
    """
    first, last = max(settled, ENDS), len(motion.position) / motion.rate - ENDS
    if last <= first:
        return None
    truth = pass_high(motion.position[:: round(motion.rate / RATE)], RATE)
    inner = slice(round(first * RATE), round(last * RATE))
    return compute_rms_length((estimate - truth)[inner])
