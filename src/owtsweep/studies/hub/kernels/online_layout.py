"""The structures that the online kernels take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, Rows
from owtsweep.estimation.riccati import TwoRates
from owtsweep.estimation.weighing import Weighing
from owtsweep.studies.hub.kernels.layout import LeanTerms, PredictorArrays

#: Indices in `OnlineRegisters.counter`: present step, present row of the registers, number of links
#: in the MHE's window, whether the window's data determine its states, fixes in a row beyond the
#: limit of their rule. COUNTERS is their number.
STEP, ROW, LINKS, DETERMINED, BEYOND, COUNTERS = 0, 1, 2, 3, 4, 5
#: The MHE's window is solved again for new weights of its fixes until no weight changes by more
#: than `LEAST_CHANGE`, but at most `MOST_WEIGHINGS` times.
MOST_WEIGHINGS, LEAST_CHANGE = 500, 1e-10
#: Indices of position, velocity and bias among the filter's four states.
PICK = (0, 1, 3)


class OnlineEstimates(NamedTuple):
    """The output of an online estimator over some steps.

    state: x, y (m), v_x, v_y (m/s), shape (steps, 4); x is north, y is east.
    covariance: of position and velocity along an axis, equal for both axes; shape (steps, 2, 2).
    innovation, innovation_variance: innovation of the position along x and y (m), shape (steps, 2),
        and its variance along each axis (m^2), shape (steps,); NaN at steps without an innovation.
    """

    state: Array
    covariance: Array
    innovation: Array
    innovation_variance: Array


class FilterSettings(NamedTuple):
    """The settings of filter, smoother and predictor, for one axis; times are in IMU steps.

    A, B, h: the filter's transition matrix (4, 4), input column (4,), and measurement row (4,) of
        specific force.
    rates: the filter's model; a position is its slow measurement, a specific force its fast one.
    P0: covariance (4, 4) of the first state.
    fix_interval, delay, window: time between fixes, delay of the specific force, the smoother's
        lag.
    ahead, response, added: the predictor's transition matrix over all its steps (3, 3), its
        response to the noise of each input (inputs, 3), and the covariance that noise during the
        prediction adds (3, 3).
    rotation, gravity: rotation (2, 2) from the IMU's frame to NED, and gravity (2,) in NED, m/s^2.
    fix_rule: how the weight of a position follows from its innovation, in standard deviations.
    """

    A: Array
    B: Array
    h: Array
    rates: TwoRates
    P0: Array
    fix_interval: int
    delay: int
    window: int
    predicts: bool
    predictor: PredictorArrays
    ahead: Array
    response: Array
    added: Array
    rotation: Array
    gravity: Array
    fix_rule: Weighing


class HorizonSettings(NamedTuple):
    """The settings of the MHE, Eq. (11) of Ren et al. (2019).

    active: whether the scheme has an MHE.
    interval: T_m, the time between the MHE's positions, in IMU steps.
    length: N_m, the number of links in the window; a link leads from one fix to the next.
    arrival: what is known about the oldest state: 0 nothing, 1 a prior, 2 the state itself.
    inputs: which IMU samples the MHE takes: 0 all, 1 averaged, 2 sampled.
    step: sampling interval of the IMU, s.
    transition: transition matrix (3, 3) from one fix to the next.
    link, inverse_sigma, prior: weights as square roots of information (inverse covariance): of a
        link (3, 3), of a fix, and of the oldest state while the window fills (3, 3).
    constrained, bounds: whether there are constraints, and the bounds (3,) of |p|, |v| and |b^b|,
        the bias in the IMU's frame; infinity for none.
    growth, lean: as in `HorizonArrays`.
    fix_rule: how the weight of a fix follows from its distance from the window's state, in standard
        deviations of a fix; no gate.
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
    growth: Array
    lean: LeanTerms
    fix_rule: Weighing


class OnlineRegisters(NamedTuple):
    """The registers of an online estimator, for two axes, x and y.

    A link leads from one node of the MHE's window to the next. Arrays with `rows` have one per
    recent step.

    counter: the counters STEP, ROW, LINKS, DETERMINED, BEYOND; shape (5,).
    P: the covariance (4, 4) of the filter's state.
    work: working memory (3, 4, 4) of the filter and the smoother.
    predicted, given: the predicted position and the position that the filter takes, m, shape (1, 2)
        each.
    force, steps, K: specific force in NED (rows, 2), filtered state and innovations as in
        `Memory.steps`, with the lanes x and y, and the gains (rows, 4, 2).
    C, Pm, Pf: the smoother's gain, and the covariances of the predicted and of the filtered state,
        shape (rows, 4, 4).
    back, inputs, estimate: the smoother's correction, what the predictor's inputs add, and the
        smoothed and then predicted state; one row each, as in `Memory`, the states with the fields
        of `steps`.
    smoothed, coupling, no_coupling: results of `estimation.windowing.covariances`, shapes
        (window + 1, 4, 4) and (window + 1, 4, 3), and a coupling of zero (4, 3).
    zero: a state of zeros (3, 2).
    z, have, weight: position fix (m) of each node, shape (nodes, 2), whether the fix arrived, and
        the square root of its weight in the window's cost.
    effects: what the specific force adds to the state from each node to the next, shape
        (links, 3, 2).
    states, covariances: the filter's position, velocity and bias at the nodes, shape (nodes, 3, 2),
        and their covariances (nodes, 3, 3).
    now: the MHE between two nodes, one row: the fields p, v, gathered and sample of `Memory.now`.
    prior: square root of the information about the oldest node (3, 3).
    node, nodes: the MHE's state at the newest node (3, 2), and at all nodes and the present
        (nodes + 1, 3, 2).
    blocks: factors of the window's least squares problem, shape (links, 3, 8).
    """

    counter: NDArray[np.int64]
    P: Array
    work: Array
    predicted: Array
    given: Array
    force: Array
    steps: Rows
    K: Array
    C: Array
    Pm: Array
    Pf: Array
    back: Rows
    inputs: Rows
    estimate: Rows
    smoothed: Array
    coupling: Array
    no_coupling: Array
    zero: Array
    z: Array
    have: NDArray[np.bool_]
    weight: Array
    effects: Array
    states: Array
    covariances: Array
    now: Rows
    prior: Array
    node: Array
    nodes: Array
    blocks: Array
