"""The structures that the kernels of the expected engine take.

A lane is one sinusoidal test input to a scheme; eight lanes make a group.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.kernels.layout import Groups


class Waves(NamedTuple):
    """The sinusoids of two groups of eight lanes (test inputs).

    Attributes
    ----------
    starts
        Cosines and sines of both groups at the first step of each block, shape (4 blocks, 8).
    now
        Cosines and sines of both groups at the next step, shape (4, 8).
    turn_gain
        Cosines and sines of the angle per step, and factors that turn sinusoids into forces, of
        both groups, shape (6, 8).
    rate
        Angular frequencies of group 0, rad/s, shape (1, 8).
    block
        Number of steps in a block, after which sinusoids start anew from `starts`.
    moving
        Whether any force differs from zero.
    phasor
        Whether group 0 holds cosines and group 1 the sines of the same angles. Otherwise each group
        holds eight different sines.
    truth
        Whether the estimates should follow the sinusoids.
    """

    starts: Array
    now: Array
    turn_gain: Array
    rate: Array
    block: int
    moving: bool
    phasor: bool
    truth: bool


class Course(NamedTuple):
    """The plan by which two groups of lanes are run and tested for a response that repeats.

    A lane is one sinusoidal test input.

    Attributes
    ----------
    lead
        Number of steps before a chunk whose force the computation of the chunk needs.
    chunk
        Number of steps computed at a time.
    settled
        The first settled step.
    cycle
        Number of steps after which the scheme's gains, fixes and moving horizon estimator repeat.
    every
        Number of steps from one test to the next.
    lanes
        Number of lanes in use: in both groups together or, for phasors, in each group.
    tolerance
        Cycles repeat if their sums of squared errors differ by at most this, relatively.
    """

    lead: int
    chunk: int
    settled: int
    cycle: int
    every: int
    lanes: int
    tolerance: float


class Buffers(NamedTuple):
    """The working memory of two groups of eight lanes (test inputs).

    Attributes
    ----------
    filled
        Two steps: the step in row 0 of `force` and `wave`, and the first step that is not filled
        yet.
    force, wave
        Specific force, and the sinusoid itself; an array (rows, 8) for each group.
    fixes
        Position fixes; an array (fixes, 8) for each group.
    sums
        Sums of squared errors, shape (8, 8); the rows are 2 parts of the record (before and after
        settling) x 2 measures x 2 groups.
    ring
        Sums of squared errors of the newest cycles, shape (4 slots, 8). A cycle is `Course.cycle`
        steps. Cycle number q is in slot q modulo the number of slots; the four rows of a slot are 2
        measures x 2 groups.
    """

    filled: NDArray[np.int64]
    force: Groups
    wave: Groups
    fixes: Groups
    sums: Array
    ring: Array
