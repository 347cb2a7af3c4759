"""The structures that the kernels of the expected engine take.

Sixteen lanes, each a sinusoidal test input, run together: sixteen sines, or eight cosines and,
behind them, their sines (phasors).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, Rows


class Waves(NamedTuple):
    """The sinusoids.

    starts: cosines (row 2 b) and sines (row 2 b + 1) at the first step of block number b, shape
        (2 blocks, 16). A lane's sinusoid is always the sine: a cosine is the sine of an angle that
        is a quarter turn larger.
    now: the sinusoids of the next step; one row with the fields c and s (cosine and sine), turn_c
        and turn_s (of the angle per step), force (what turns a sine into a specific force) and rate
        (angular frequency, rad/s).
    block: number of steps after which sinusoids start again from `starts`.
    moving: whether any force differs from zero.
    phasor: whether the lanes are phasors.
    truth: whether the estimates should follow the sinusoids.
    """

    starts: Array
    now: Rows
    block: int
    moving: bool
    phasor: bool
    truth: bool


class Course(NamedTuple):
    """The plan by which lanes are run and tested for a response that repeats; times are in steps.

    lead: number of steps before a chunk whose force the chunk needs.
    chunk: length of a chunk.
    settled: the first settled step.
    cycle: time after which the scheme's gains, fixes and MHE repeat.
    every: time from one test to the next.
    lanes: number of lanes in use; for phasors, of cosines alone.
    tolerance: cycles repeat if their sums of squared errors differ by at most this, relatively.
    """

    lead: int
    chunk: int
    settled: int
    cycle: int
    every: int
    lanes: int
    tolerance: float


class Buffers(NamedTuple):
    """The working memory of sixteen lanes.

    filled: the step in row 0 of `force` and `wave`, and the first step that is not filled yet.
    force, wave: specific force, shape (rows, 16), and the sinusoid itself and its rate, shape
        (rows, 32).
    fixes: position fixes, shape (fixes, 16).
    errors: one row with the fields p, v (estimates), wave (sinusoid and rate), and pp, vv
        (sums of squared errors), which the compiler can tell apart.
    sums: sums of squared errors, shape (2, 2, 16): parts of the record (before and after settling),
        measures, lanes. For phasors, the cosines' lanes hold the sum of both.
    ring: sums of squared errors of the newest cycles, shape (slots, 2, 16). Cycle number q is in
        slot q modulo the number of slots.
    """

    filled: NDArray[np.int64]
    force: Array
    wave: Array
    fixes: Array
    errors: Rows
    sums: Array
    ring: Array
