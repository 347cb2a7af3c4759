"""The structures of arrays that kernels take."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.vectors import WIDTH as WIDTH  # imported from here elsewhere

#: Which IMU samples the MHE takes; the same order as `hub.horizon.INPUTS`.
ALL, AVERAGED, SAMPLED = 0, 1, 2

#: One array per group of eight lanes; kernels process all groups side by side.
Groups = tuple[Array, ...]


class FilterArrays(NamedTuple):
    """The filter and smoother along one axis; states are position, velocity, acceleration, bias.

    Attributes
    ----------
    A, B, h
        Transition matrix (4, 4), input column (4,), and measurement row (4,) of specific force.
    K, applied
        Gains of position and specific force (rows, 4, 2); whether a row has a position to apply
        (rows,).
    C, D
        The smoother's gains (rows, 4, 4), and its gains for the innovations that leave the window
        (rows, 4, 2).
    cycle
        After the last row of K, C and D, the last `cycle` rows repeat.
    input_delay, window, fix_interval
        Delay of the specific force, length of the smoother's window, and time between fixes, all in
        steps.
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
    """An open-loop prediction over `steps` steps of `step` seconds, with position, velocity, bias.

    `half` is the change of position per step and unit input, step^2 / 2. `pv`, `pb` and `vb` say
    what velocity and bias add to position, and bias to velocity, over all steps.
    """

    steps: int
    step: float
    half: float
    pv: float
    pb: float
    vb: float


class HorizonArrays(NamedTuple):
    """The moving horizon estimator (MHE) without constraints: matrices that turn data into states.

    Attributes
    ----------
    active
        Whether the scheme has an MHE.
    maps
        One matrix (3, columns) per fix number; the last one serves all later fixes. See
        `estimation.mhe.window_map`.
    horizon, interval
        N_m, the number of links between fixes in a full window, and T_m in steps.
    first
        Number of the first fix at which the window can be solved.
    arrival
        Whether the window has an arrival state.
    inputs
        Which IMU samples are taken: ALL, AVERAGED or SAMPLED.
    step
        Sampling interval of the IMU, s.
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
    """The arrays of a whole scheme: filter, predictor, moving horizon estimator."""

    filter: FilterArrays
    predictor: PredictorArrays
    mhe: HorizonArrays


class Registers(NamedTuple):
    """The memory that each lane carries from chunk to chunk.

    Each field has an array (rows, 8) for each group of eight lanes.

    Attributes
    ----------
    x
        The filter's state; 4 rows.
    r, s
        The newest innovations of specific force and of position; `window` rows each.
    X
        The newest filtered states; 4 window rows.
    z
        The MHE's position fixes; horizon + 1 rows.
    ip, iv
        Effects of the inputs on position and velocity between fixes; `horizon` rows each.
    arrival
        Past filtered states at fixes; 3 (horizon + 1) rows.
    running
        Sums over the inputs since the last fix; 4 rows.
    node
        State of the newest node of the MHE; 3 rows.
    fix
        The position that the filter takes; 1 row.
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
    """The memory that is used within a chunk only; all runs share it, so it stays in the cache.

    Each field has an array (rows, 8) for each group of eight lanes.

    Attributes
    ----------
    r, s
        Innovations of specific force and of position; window + chunk rows each.
    X
        States, up to four rows per step; 4 (window + chunk) rows.
    inputs
        The predictor's sums over the inputs; 2 rows.
    positions
        The positions that the MHE gives the filter, one per multiple of T_m; `chunk` rows.
    """

    r: Groups
    s: Groups
    X: Groups
    inputs: Groups
    positions: Groups


class Output(NamedTuple):
    """A chunk's estimates; each field has an array (steps, 8) for each group of eight lanes."""

    position: Groups
    velocity: Groups
    innovation: Groups


class Memory(NamedTuple):
    """The memory of a running chain: registers, working memory and the chunk's estimates."""

    registers: Registers
    scratch: Scratch
    output: Output


class Fed(NamedTuple):
    """The data that a chain runs on.

    Attributes
    ----------
    force
        Specific force, m/s^2; an array (rows, 8) for each group of eight lanes.
    base
        The specific force of step k is in row k - base.
    fixes
        Position fixes, m; an array (fixes, 8) for each group.
    """

    force: Groups
    base: int
    fixes: Groups


class Truth(NamedTuple):
    """The true motion, with which the estimates are compared.

    Attributes
    ----------
    position, velocity
        Displacement along the wave (m) and its rate (m/s); a tuple of one array (rows, 8) each.
        Step k is in the same row as in `Fed`.
    direction
        The wave's direction cosines along x and y, times an amplitude; shape (2,).
    """

    position: Groups
    velocity: Groups
    direction: Array


class Steps(NamedTuple):
    """The steps first ... stop - 1 of a chunk; the chunk begins at the record's step k0.

    The estimates of the chunk's step i are in row i - shift of the output.
    """

    k0: int
    first: int
    stop: int
    shift: int


def new_registers(groups: int, window: int, horizon: int) -> Registers:
    """Make registers for some groups of lanes, all zero, as every algorithm of the paper starts.

    `window` is the smoother's window in steps, `horizon` the number of links in the MHE's window.
    """
    rows = (
        4, window, window, 4 * window, horizon + 1, horizon, horizon, 3 * (horizon + 1), 4, 3, 1,
    )  # fmt: skip
    # slices of one array: making eleven arrays takes longer than a short run
    block = aligned(groups, sum(max(n, 1) for n in rows), WIDTH)
    stops = np.cumsum([max(n, 1) for n in rows]).tolist()
    return Registers(*(tuple(block[:, a:b]) for a, b in pairwise([0, *stops])))


def new_scratch(groups: int, chunk: int, window: int) -> Scratch:
    """Make working memory for chunks of `chunk` steps and a smoother's window of `window` steps."""
    steps = window + chunk
    rows = (steps, steps, 4 * steps, 2, chunk)
    return Scratch(*(_zeros(groups, n) for n in rows))


def new_output(groups: int, chunk: int) -> Output:
    """Make memory for the estimates of a chunk of `chunk` steps."""
    return Output(*(_zeros(groups, chunk) for _ in Output._fields))


def _zeros(groups: int, rows: int) -> Groups:
    return tuple(aligned(groups, rows, WIDTH))


class Weights(NamedTuple):
    """The weights of errors in NEES and NIS, for each row of the gain schedule.

    Attributes
    ----------
    precision
        Elements pp, pv, vv of the inverse covariance of position and velocity along an axis, shape
        (rows, 3).
    innovation
        Inverse of the innovation's variance, shape (rows,).
    fresh
        Whether there is an innovation, shape (rows,).
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]
