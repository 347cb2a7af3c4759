"""The structures that the kernels of the expected engine take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.kernels.layout import Groups


class Waves(NamedTuple):
    """The sinusoids of two groups of lanes.

    starts (4 blocks, 8): cosines and sines of both groups where blocks begin; now (4, 8): those of
    the step that comes next; turn_gain (6, 8): cosines and sines of an angle per step, and the
    factors that turn sinusoids into forces; rate (1, 8): angular frequencies, rad/s; block: the
    number of steps in a block. moving: whether there is any force. phasor: whether group 0 holds
    cosines and group 1 their sines; else each holds eight different sines. truth: whether the
    estimates should follow them.
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
    """How two groups are run, and when their response is tested for repetition. Numbers are steps.

    lead: rows that a chunk needs before its first step; chunk: steps computed at a time; settled:
    the first settled step; cycle: steps after which the chain's gains, fixes and MHE repeat; every:
    steps between two tests; lanes: how many are in use; tolerance: the largest relative change of a
    cycle's energy that counts as none.
    """

    lead: int
    chunk: int
    settled: int
    cycle: int
    every: int
    lanes: int
    tolerance: float


class Buffers(NamedTuple):
    """The working memory of two groups.

    filled (2,): the step of row 0 of force and wave, and the step up to which they are filled;
    force, wave (rows, 8) of each group; fixes (fixes, 8) of each group; sums (8, 8) with the rows
    (2 parts of the record, 2 measures, 2 groups); ring (4 slots, 8), slots of (2 measures, 2
    groups): the sums of the newest cycles, with cycle q in slot q % slots.
    """

    filled: NDArray[np.int64]
    force: Groups
    wave: Groups
    fixes: Groups
    sums: Array
    ring: Array
