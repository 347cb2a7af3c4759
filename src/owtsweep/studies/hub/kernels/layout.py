"""The arrays that kernels take, grouped and named."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.vectors import WIDTH as WIDTH  # where others look for it

#: How the MHE takes the IMU's samples; the same order as `hub.horizon.INPUTS`.
ALL, AVERAGED, SAMPLED = 0, 1, 2

#: An array per group of eight lanes; compiled code works on all of them side by side.
Groups = tuple[Array, ...]


class FilterArrays(NamedTuple):
    """One axis of the Kalman filter: states (p, v, a, b).

    A (4, 4), B (4,) input column, h (4,) force row, K (rows, 4, 2), applied (rows,), C (rows, 4, 4)
    smoother gains and D (rows, 4, 2) what leaves its window, cycle, input_delay and window in
    steps, fix_interval M.
    """

    A: Array
    B: Array
    h: Array
    K: Array
    applied: NDArray[np.bool_]
    C: Array
    D: Array
    cycle: int
    input_delay: int
    window: int
    fix_interval: int


class PredictorArrays(NamedTuple):
    """Open-loop prediction over `steps` steps of `step` s with Sigma_2.

    pv, pb, vb: elements of A^steps; half: position gained per step and unit input, T^2/2.
    """

    steps: int
    step: float
    half: float
    pv: float
    pb: float
    vb: float


class HorizonArrays(NamedTuple):
    """The unconstrained MHE as linear maps.

    active, maps (count, 3, columns), horizon N_m, interval (steps of T_m), first fix number with
    a solution, arrival (0 or 1), inputs (0 all, 1 averaged, 2 sampled), step s.
    """

    active: bool
    maps: Array
    horizon: int
    interval: int
    first: int
    arrival: bool
    inputs: int
    step: float


class ChainArrays(NamedTuple):
    """A whole scheme: filter, predictor, moving horizon estimator."""

    filter: FilterArrays
    predictor: PredictorArrays
    mhe: HorizonArrays


class Registers(NamedTuple):
    """What lanes carry from chunk to chunk; each field has an array (rows, 8) per group of eight.

    x (4) the filter's state; r, s (window) and X (4 window) the newest innovations, of specific
    force and position, and filtered states; the MHE's registers: z (horizon + 1) fixes, ip and iv
    (horizon) effects of the inputs per interval, arrival (3 (horizon + 1)) past states, running (4)
    the present interval's inputs, node (3) the newest node, fix (1) the position that the filter
    takes.
    """

    x: Groups
    r: Groups
    s: Groups
    X: Groups
    z: Groups
    ip: Groups
    iv: Groups
    arrival: Groups
    running: Groups
    node: Groups
    fix: Groups


class Scratch(NamedTuple):
    """What is needed within a chunk only: all runs share it, so that it stays in the cache.

    Each field has an array per group of lanes.
    r and s (window + chunk, 8) innovations; X (4 (window + chunk), 8) states, up to four rows per
    step; inputs (2, 8) what the predictor has of them; positions (chunk, 8) what the MHE gives the
    filter, one per tick of T_m.
    """

    r: Groups
    s: Groups
    X: Groups
    inputs: Groups
    positions: Groups


class Output(NamedTuple):
    """A chunk's estimates, of each group of lanes an array (steps, 8)."""

    position: Groups
    velocity: Groups
    innovation: Groups


class Memory(NamedTuple):
    """All memory of a running chain: registers, working memory and the chunk's estimates."""

    registers: Registers
    scratch: Scratch
    output: Output


class Fed(NamedTuple):
    """What a chain is fed with.

    force (rows, 8) for each group of lanes: the specific force of step k in row k - base, m/s^2;
    fixes (fixes, 8) for each group: positions, m.
    """

    force: Groups
    base: int
    fixes: Groups


class Truth(NamedTuple):
    """What the estimates are judged by.

    position and velocity: one array (rows, 8) each, the displacement along the wave and its rate,
    of step k in the row that `Fed` has it; direction (2,): the wave's cosines, times an amplitude.
    """

    position: Groups
    velocity: Groups
    direction: Array


class Totals(NamedTuple):
    """Where squared errors go.

    sums: one array (36, 8), see `kernels.sums`; squared: one array (steps, 8) of the squared error
    of the position, filled where `keep` says so.
    """

    sums: Groups
    squared: Groups
    keep: bool


class Stretch(NamedTuple):
    """Steps begin ... stop - 1 of a record, worked through `chunk` at a time.

    From step `settled` on errors count as settled.
    """

    begin: int
    stop: int
    chunk: int
    settled: int


class Steps(NamedTuple):
    """Steps first ... stop - 1 of the chunk that begins at the record's step k0.

    The estimates of step i stand in row i - shift of the output.
    """

    k0: int
    first: int
    stop: int
    shift: int


class Positions(NamedTuple):
    """Positions that a filter takes: fixes, or what the MHE makes of them.

    The first one it may take is row `row`; the next is due after interval - phase steps, then
    every `interval` steps.
    """

    rows: Groups
    row: int
    phase: int
    interval: int


class Window(NamedTuple):
    """What a smoother works on: states, and innovations of force and position; see `Scratch`."""

    X: Groups
    r: Groups
    s: Groups


class ImuNoise(NamedTuple):
    """What makes an IMU's noise of unit normals: the bias' step and start, sigma, gravity (2,)."""

    walk: float
    initial: float
    sigma: float
    gravity: Array


def new_registers(groups: int, window: int, horizon: int) -> Registers:
    """Registers of some groups of lanes, all zero, as every algorithm of the paper starts."""
    rows = (
        4, window, window, 4 * window, horizon + 1, horizon, horizon, 3 * (horizon + 1), 4, 3, 1,
    )  # fmt: skip
    # one array, cut into pieces: to make eleven takes longer than a short run
    block = aligned(groups, sum(max(n, 1) for n in rows), WIDTH)
    stops = np.cumsum([max(n, 1) for n in rows]).tolist()
    return Registers(*(tuple(block[:, a:b]) for a, b in pairwise([0, *stops])))


def new_scratch(groups: int, chunk: int, window: int) -> Scratch:
    """Working memory for chunks of that many steps."""
    steps = window + chunk
    rows = (steps, steps, 4 * steps, 2, chunk)
    return Scratch(*(_zeros(groups, n) for n in rows))


def new_output(groups: int, chunk: int) -> Output:
    """Memory for a chunk's estimates."""
    return Output(*(_zeros(groups, chunk) for _ in Output._fields))


def _zeros(groups: int, rows: int) -> Groups:
    return tuple(aligned(groups, rows, WIDTH))


class Weights(NamedTuple):
    """What NEES and NIS weigh errors with, by schedule row.

    precision (rows, 3) is the inverse of the (p, v) covariance of one axis, innovation (rows,) the
    inverse of the innovation's variance, fresh (rows,) where there is one.
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]
