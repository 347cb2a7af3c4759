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
    """One axis of the Kalman filter: states (p, v, a, b).

    A (4, 4), B (4,) input column, h (4,) force row, K (rows, 4, 2), applied (rows,). C (rows, 4, 4)
    are the smoother's gains; D (rows, 4, 2) are the gains for the innovations that leave its
    window. cycle, input_delay, window and fix_interval (M) are in steps.
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

    pv, pb, vb: elements of A^steps; half: the change of position per step and unit input, T^2/2.
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

    x (4): the filter's state. r, s (window): the newest innovations of specific force and position;
    X (4 window): the newest filtered states. The MHE's registers are z (horizon + 1): fixes; ip, iv
    (horizon): effects of the inputs on position and velocity per interval; arrival
    (3 (horizon + 1)): past states; running (4): sums over the present interval's inputs; node (3):
    the newest node; fix (1): the position that the filter takes.
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
    """Memory that is used within a chunk only. All runs share it, so that it stays in the cache.

    Each field has an array per group of lanes.
    r and s (window + chunk, 8): innovations. X (4 (window + chunk), 8): states, up to four rows per
    step. inputs (2, 8): the predictor's sums over the inputs. positions (chunk, 8): the positions
    that the MHE gives the filter, one per multiple of T_m.
    """

    r: Groups
    s: Groups
    X: Groups
    inputs: Groups
    positions: Groups


class Output(NamedTuple):
    """A chunk's estimates; each field has an array (steps, 8) per group of lanes."""

    position: Groups
    velocity: Groups
    innovation: Groups


class Memory(NamedTuple):
    """All memory of a running chain: registers, working memory and the chunk's estimates."""

    registers: Registers
    scratch: Scratch
    output: Output


class Fed(NamedTuple):
    """The data that a chain runs on.

    force (rows, 8) for each group of lanes: the specific force of step k in row k - base, m/s^2;
    fixes (fixes, 8) for each group: positions, m.
    """

    force: Groups
    base: int
    fixes: Groups


class Truth(NamedTuple):
    """The true motion, with which the estimates are compared.

    position and velocity: one array (rows, 8) each, the displacement along the wave and its rate;
    step k is in the same row as in `Fed`. direction (2,): the wave's direction cosines times an
    amplitude.
    """

    position: Groups
    velocity: Groups
    direction: Array


class Steps(NamedTuple):
    """Steps first ... stop - 1 of the chunk that begins at the record's step k0.

    The estimates of step i are in row i - shift of the output.
    """

    k0: int
    first: int
    stop: int
    shift: int


def new_registers(groups: int, window: int, horizon: int) -> Registers:
    """Registers of some groups of lanes, all zero, as every algorithm of the paper starts."""
    rows = (
        4, window, window, 4 * window, horizon + 1, horizon, horizon, 3 * (horizon + 1), 4, 3, 1,
    )  # fmt: skip
    # slices of one array: making eleven arrays takes longer than a short run
    block = aligned(groups, sum(max(n, 1) for n in rows), WIDTH)
    stops = np.cumsum([max(n, 1) for n in rows]).tolist()
    return Registers(*(tuple(block[:, a:b]) for a, b in pairwise([0, *stops])))


def new_scratch(groups: int, chunk: int, window: int) -> Scratch:
    """Working memory for chunks of `chunk` steps."""
    steps = window + chunk
    rows = (steps, steps, 4 * steps, 2, chunk)
    return Scratch(*(_zeros(groups, n) for n in rows))


def new_output(groups: int, chunk: int) -> Output:
    """Memory for a chunk's estimates."""
    return Output(*(_zeros(groups, chunk) for _ in Output._fields))


def _zeros(groups: int, rows: int) -> Groups:
    return tuple(aligned(groups, rows, WIDTH))


class Weights(NamedTuple):
    """The weights of errors in NEES and NIS, by schedule row.

    precision (rows, 3) is the inverse of the (p, v) covariance of one axis; innovation (rows,) is
    the inverse of the innovation's variance; fresh (rows,) says whether there is an innovation.
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]
