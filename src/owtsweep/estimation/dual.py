"""The dual Kalman filter: one filter for the inputs, one for the states.

Eftekhar Azam, Chatzi and Papadimitriou, "A dual Kalman filter approach for state estimation via
output-only acceleration measurements", Mechanical Systems and Signal Processing 60-61 (2015). The
idea: a first Kalman filter takes the states as known and estimates the inputs, as random walks that
are measured through the direct feedthrough J. A second one takes these inputs as known and
estimates the states. Both use the same measurement, and neither knows the other's covariance. So
the loop of both may be unstable though each of them alone is not: look at `Filter.radius`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.input_state import Filter, InputStateModel, Step, settle
from owtsweep.estimation.square_root import Correction, deviation, kalman


def make_dual(
    model: InputStateModel, Q: Array, S: Array, R: Array, P0_x: Array, P0_p: Array
) -> Filter:
    """Make the dual Kalman filter.

    Q, S, R: as of `augmented.make_augmented`.
    P0_x, P0_p: covariances of states and of inputs one step before the first measurement, shapes
        (n, n) and (inputs, inputs).
    The input filter takes the state at k for A x^[k-1] + B p^[k-1], which fits the model, in which
    the input p[k-1] drives the state from k-1 to k.
    Raises InputError if a matrix is no covariance, or R is singular.
    """
    inputs = model.B.shape[1]
    pairs = zip(
        kalman(np.eye(inputs), model.J, S, R, P0_p),
        kalman(model.A, model.G, Q, R, P0_x),
        strict=True,
    )
    return settle(_join(model, of_p, of_x) for of_p, of_x in pairs)


def _join(model: InputStateModel, of_p: Correction, of_x: Correction) -> Step:
    """Join the gains of the input filter and the state filter to one step of the state [x, p]."""
    A, B, G, J = model.A, model.B, model.G, model.J
    n, inputs = B.shape
    only_x, only_p = np.eye(n, n + inputs), np.eye(n + inputs)[n:]
    predicted = A @ only_x + B @ only_p
    new_p = only_p - of_p.K @ (G @ predicted + J @ only_p)
    return Step(
        F=np.vstack([predicted - of_x.K @ (G @ predicted + J @ new_p), new_p]),
        K=np.vstack([of_x.K - of_x.K @ J @ of_p.K, of_p.K]),
        states=np.concatenate([deviation(of_x.predicted), deviation(of_p.predicted)]),
        corrections=np.vstack([of_x.corrections, of_p.corrections]),
    )
