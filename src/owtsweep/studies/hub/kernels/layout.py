"""The arrays that kernels take, grouped and named."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Lanes that run side by side in one vector; `kernels.vector.WIDTH`, without importing numba.
WIDTH = 8


class FilterArrays(NamedTuple):
    """One axis of the Kalman filter: states (p, v, a, b).

    A (4, 4), B (4,) input column, h (4,) force row, K (rows, 4, 2), applied (rows,), C and W
    (rows, 4, 4) smoother gains and window products, cycle, input_delay and window in steps,
    fix_interval M.
    """

    A: Array
    B: Array
    h: Array
    K: Array
    applied: NDArray[np.bool_]
    C: Array
    W: Array
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
    """What eight lanes carry from chunk to chunk; every array is (rows, 8).

    x (4) the filter's state; e and X (4 window) the newest corrections and filtered states; the
    MHE's registers: z (horizon + 1) fixes, ip and iv (horizon) effects of the inputs per interval,
    arrival (3 (horizon + 1)) past states, running (4) the present interval's inputs, node (3) the
    newest node, fix (1) the position that the filter takes.
    """

    x: Array
    e: Array
    X: Array
    z: Array
    ip: Array
    iv: Array
    arrival: Array
    running: Array
    node: Array
    fix: Array


class Scratch(NamedTuple):
    """What a chunk needs and leaves to nobody: shared by all lanes, so that it stays in the cache.

    e and X (4 (window + chunk), 8) corrections and states, four rows per step; V and P (chunk +
    prediction + 1, 8) sums of inputs; positions (chunk, 8) what the MHE gives the filter.
    """

    e: Array
    X: Array
    V: Array
    P: Array
    positions: Array


class Output(NamedTuple):
    """A chunk's estimates: position, velocity, innovation, (steps, lanes) each."""

    position: Array
    velocity: Array
    innovation: Array


def new_registers(groups: int, window: int, horizon: int) -> Registers:
    """Registers of some groups of lanes, (groups, rows, 8): zero, as all of the paper starts."""
    rows = (
        4, 4 * window, 4 * window, horizon + 1, horizon, horizon, 3 * (horizon + 1), 4, 3, 1,
    )  # fmt: skip
    return Registers(*(np.zeros((groups, max(n, 1), WIDTH)) for n in rows))


def new_scratch(chunk: int, window: int, prediction: int) -> Scratch:
    """Working memory for chunks of that many steps."""
    rows = (4 * (window + chunk), 4 * (window + chunk), *[chunk + prediction + 1] * 2, chunk)
    return Scratch(*(np.zeros((n, WIDTH)) for n in rows))


def new_output(groups: int, chunk: int) -> Output:
    """Room for a chunk's estimates, (groups, chunk, 8)."""
    return Output(*(np.zeros((groups, chunk, WIDTH)) for _ in Output._fields))


class Weights(NamedTuple):
    """What NEES and NIS weigh errors with, by schedule row.

    precision (rows, 3) is the inverse of the (p, v) covariance of one axis, innovation (rows,) the
    inverse of the innovation's variance, fresh (rows,) where there is one.
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]
