"""The structures that the online kernels take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Places of the counters: step, row of the registers, links in the window, whether the window is
#: determined; and the number of counters.
STEP, ROW, LINKS, DETERMINED, COUNTERS = 0, 1, 2, 3, 4


class OnlineEstimates(NamedTuple):
    """The output of an estimator over some steps.

    state (steps, 4): x, y, v_x, v_y in NED; covariance (steps, 2, 2) of (p, v), the same for
    both axes; innovation (steps, 2) and innovation_variance (steps,), NaN at steps without one.
    """

    state: Array
    covariance: Array
    innovation: Array
    innovation_variance: Array


class FilterSettings(NamedTuple):
    """Filter, smoother and predictor: one axis' model, and times in IMU steps.

    Filter: A, Q (4, 4), B (4,), slow and fast (4,) measurement rows with variances r_slow and
    r_fast, rule (index of `RULES`), P0 (4, 4). Predictor: input_A (3, 3) and input_B (3,); ahead
    (3, 3) is its transition over all steps, response (steps, 3) its response to the inputs' noise,
    added (3, 3) the covariance from that noise alone. rotation (2, 2) from the IMU's frame to NED,
    gravity (2,).
    """

    A: Array
    B: Array
    Q: Array
    slow: Array
    fast: Array
    r_slow: float
    r_fast: float
    rule: int
    P0: Array
    fix_interval: int
    delay: int
    window: int
    predicts: bool
    input_A: Array
    input_B: Array
    ahead: Array
    response: Array
    added: Array
    rotation: Array
    gravity: Array


class HorizonSettings(NamedTuple):
    """The MHE: T_m in steps, N_m, and Eq. (11)'s weights as square roots of information.

    arrival: 0 none, 1 prior, 2 fixed. bounds (3,) of |p|, |v|, |b^b|; infinite if there is none.
    """

    active: bool
    interval: int
    length: int
    arrival: int
    inputs: int
    step: float
    transition: Array
    link: Array
    inverse_sigma: float
    prior: Array
    constrained: bool
    bounds: Array


class OnlineRegisters(NamedTuple):
    """One estimator's registers; see `online.registers.new_registers` for their shapes."""

    counter: NDArray[np.int64]
    x: Array
    P: Array
    K: Array
    work: Array
    predicted: Array
    innovation: Array
    given: Array
    force: Array
    X: Array
    e: Array
    C: Array
    Pm: Array
    Pf: Array
    smoothed: Array
    coupling: Array
    no_coupling: Array
    zero: Array
    z: Array
    have: NDArray[np.bool_]
    effects: Array
    states: Array
    covariances: Array
    running: Array
    recent: Array
    held: Array
    prior: Array
    node: Array
    nodes: Array
    blocks: Array
