"""The arrays that kernels take, grouped and named."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array


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


class Memory(NamedTuple):
    """What is carried from chunk to chunk, for `lanes` lanes.

    x (4, lanes); e and X (window + chunk, 4, lanes) corrections and filtered states; position and
    velocity (chunk, lanes) estimates; innovation (chunk, lanes); V and P (chunk + prediction + 1,
    lanes) sums of inputs; S (2, 4, lanes) smoothing sums; the MHE's registers.
    """

    x: Array
    e: Array
    X: Array
    position: Array
    velocity: Array
    innovation: Array
    V: Array
    P: Array
    S: Array
    fix: Array
    z: Array
    ip: Array
    iv: Array
    arrival: Array
    running: Array
    node: Array


def new_memory(lanes: int, chunk: int, window: int, prediction: int, horizon: int) -> Memory:
    """Registers at zero, as every algorithm of the paper starts."""
    return Memory(
        x=np.zeros((4, lanes)),
        e=np.zeros((window + chunk, 4, lanes)),
        X=np.zeros((window + chunk, 4, lanes)),
        position=np.zeros((chunk, lanes)),
        velocity=np.zeros((chunk, lanes)),
        innovation=np.zeros((chunk, lanes)),
        V=np.zeros((chunk + prediction + 1, lanes)),
        P=np.zeros((chunk + prediction + 1, lanes)),
        S=np.zeros((2, 4, lanes)),
        fix=np.zeros(lanes),
        z=np.zeros((horizon + 1, lanes)),
        ip=np.zeros((max(horizon, 1), lanes)),
        iv=np.zeros((max(horizon, 1), lanes)),
        arrival=np.zeros((horizon + 1, 3, lanes)),
        running=np.zeros((4, lanes)),
        node=np.zeros((3, lanes)),
    )
