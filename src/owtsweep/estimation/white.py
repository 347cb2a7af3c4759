"""The Kalman filter of a model whose inputs are white noise.

The same input p[k] drives the state and enters the measurement, so the noises of process and
measurement are correlated. The filter's state is [x[k], p[k]] with a new p at each step: the
correlation is then exact, and the input is estimated too.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from owtsweep.arrays import Array
from owtsweep.estimation.augmented import augment
from owtsweep.estimation.input_state import Filter, InputStateModel, make_kalman


def make_white(model: InputStateModel, Q: Array, S: Array, R: Array, P0: Array) -> Filter:
    """Make the Kalman filter of a model whose inputs are white noise with mean zero.

    Parameters
    ----------
    model
        The model of n states and its inputs.
    Q
        Covariance of the process noise w per step, without the inputs, shape (n, n).
    S
        Covariance of the inputs at each step, shape (inputs, inputs).
    R
        Covariance of the sensors' noise, shape (m, m).
    P0
        Covariance of the states one step before the first measurement, shape (n, n).

    Raises
    ------
    InputError
        If a matrix is no covariance, or R is singular.
    """
    inputs = model.B.shape[1]
    F, H = augment(model, np.zeros((inputs, inputs)))
    return make_kalman(F, H, block_diag(Q, S), R, block_diag(P0, S))
