"""The structures that the online kernels take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Places of the counters: present step, present row of the registers, links in the MHE's window,
#: whether the window's data determine its states. COUNTERS is the number of counters.
STEP, ROW, LINKS, DETERMINED, COUNTERS = 0, 1, 2, 3, 4


class OnlineEstimates(NamedTuple):
    """The output of an online estimator over some steps.

    Attributes
    ----------
    state
        Shape (steps, 4): x, y (m), v_x, v_y (m/s); x is north, y is east.
    covariance
        Shape (steps, 2, 2): covariance of position and velocity along an axis, equal for both axes.
    innovation, innovation_variance
        Shapes (steps, 2) and (steps,); NaN at steps without an innovation.
    """

    state: Array
    covariance: Array
    innovation: Array
    innovation_variance: Array


class FilterSettings(NamedTuple):
    """The settings of filter, smoother and predictor, for one axis; times are in IMU steps.

    Attributes
    ----------
    A, B, Q
        The filter's model, shapes (4, 4), (4,), (4, 4).
    slow, fast, r_slow, r_fast
        Measurement rows (4,) of position and specific force, and the variances of their noises.
    rule
        Index in `estimation.gains.RULES`: how a step without a position fix is treated.
    P0
        Covariance (4, 4) of the first state.
    fix_interval, delay, window
        Steps between position fixes, delay of the specific force, length of the smoother's window.
    predicts
        Whether there is a predictor.
    input_A, input_B
        The predictor's model, shapes (3, 3) and (3,).
    ahead, response, added
        The predictor's transition over all its steps (3, 3), its response to the noise of each
        input (steps, 3), and the covariance that noise on the way adds (3, 3).
    rotation, gravity
        Rotation (2, 2) from the IMU's frame to NED, and gravity (2,) in NED, m/s^2.
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
    """The settings of the moving horizon estimator (MHE), Eq. (11) of Ren et al. (2019).

    Attributes
    ----------
    active
        Whether the scheme has an MHE.
    interval, length
        T_m in IMU steps, and N_m, the number of links between fixes in the window.
    arrival
        What is known about the oldest state: 0 nothing, 1 a prior, 2 the state itself.
    inputs
        Which IMU samples the MHE takes: 0 all, 1 averaged, 2 sampled.
    step
        Sampling interval of the IMU, s.
    transition
        Transition matrix (3, 3) from one fix to the next.
    link, inverse_sigma, prior
        Weights as square roots of information (inverse covariance): of a link (3, 3), of a fix, and
        of the oldest state while the window fills (3, 3).
    constrained, bounds
        Whether there are constraints, and the bounds (3,) of |p|, |v| and |b^b|, the bias in the
        IMU's frame; infinite where there is none.
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
    """The registers of an online estimator; `online.registers.new_registers` shows their shapes."""

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
