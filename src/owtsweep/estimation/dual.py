"""The dual Kalman filter: one filter for the inputs, one for the states.

Eftekhar Azam, Chatzi and Papadimitriou, "A dual Kalman filter approach for state estimation via
output-only acceleration measurements", Mechanical Systems and Signal Processing 60-61 (2015). The
idea: a first Kalman filter takes the states as known and estimates the inputs, as random walks that
are measured through the direct feedthrough J. A second one takes these inputs as known and
estimates the states. Both use the same measurement, and neither knows the other's covariance. So
the loop of both may be unstable though each of them alone is not: look at `Filter.radius`.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.estimation.input_state import (
    Filter,
    InputStateModel,
    Step,
    settle,
)
from owtsweep.estimation.square_root import Correction, deviation, kalman

#: Which state the input filter takes as known; see `make_dual`.
READINGS = ("predicted", "previous")


def make_dual(
    model: InputStateModel,
    Q: Array,
    S: Array,
    R: Array,
    P0_x: Array,
    P0_p: Array,
    reading: Literal["predicted", "previous"] = "predicted",
) -> Filter:
    """Make the dual Kalman filter.

    Q, S, R: as of `augmented.make_augmented`.
    P0_x, P0_p: covariances of states and of inputs one step before the first measurement, shapes
        (n, n) and (inputs, inputs).
    reading: what the input filter takes for the state at k. "predicted" fits the model, in which
        the input p[k-1] drives the state from k-1 to k: A x^[k-1] + B p^[k-1]. "previous" takes
        x^[k-1] itself, and the new input p^[k] then drives the state from k-1 to k: our reading of
        the printed algorithm, whose discrete model holds the input of the step's end.
    Raises InputError if a matrix is no covariance, R is singular, or the reading is unknown.
    """
    require(reading in READINGS, f"reading: {reading!r} is not one of {', '.join(READINGS)}")
    inputs = model.B.shape[1]
    pairs = zip(
        kalman(np.eye(inputs), model.J, S, R, P0_p),
        kalman(model.A, model.G, Q, R, P0_x),
        strict=True,
    )
    return settle(_join(model, of_p, of_x, reading) for of_p, of_x in pairs)


def _join(model: InputStateModel, of_p: Correction, of_x: Correction, reading: str) -> Step:
    """Join the gains of the input filter and the state filter to one step of the state [x, p]."""
    A, B, G, J = model.A, model.B, model.G, model.J
    n, inputs = B.shape
    only_x, only_p = np.eye(n, n + inputs), np.eye(n + inputs)[n:]
    # Each quantity is (matrix of the old [x, p], matrix of y).
    predicted = A @ only_x + B @ only_p
    known = predicted if reading == "predicted" else only_x
    new_p = only_p - of_p.K @ (G @ known + J @ only_p)
    if reading == "previous":
        before, before_y = A @ only_x + B @ new_p, B @ of_p.K
    else:
        before, before_y = predicted, np.zeros((n, len(G)))
    new_x = before - of_x.K @ (G @ before + J @ new_p)
    new_x_y = before_y + of_x.K - of_x.K @ (G @ before_y + J @ of_p.K)
    return Step(
        F=np.vstack([new_x, new_p]),
        K=np.vstack([new_x_y, of_p.K]),
        states=np.concatenate([deviation(of_x.predicted), deviation(of_p.predicted)]),
        corrections=np.vstack([of_x.corrections, of_p.corrections]),
    )
