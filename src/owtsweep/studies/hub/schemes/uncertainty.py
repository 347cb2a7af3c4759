"""Computes the covariance of a smoothed and predicted estimate from the filter's covariances.

As long as every position fix arrives when it is due, the filter's gains are known in advance, and
`hub.chain` provides this covariance. Once a fix is missing, this module computes the covariance
from the filter's past. The compiled estimator shares no code with this module, so that each of the
two can test the other.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.predictor import prediction_noise
from owtsweep.studies.hub.models import SIGMA_2_STATES, AxisFilter


def predicted_covariance(
    filtered: list[Array], predicted: list[Array], axis: AxisFilter, model: Discrete, steps: int
) -> Array:
    """Compute the covariance of a predicted position and velocity along one axis, shape (2, 2).

    The prediction starts from the smoothed state of the oldest step s of the smoother's window and
    covers `steps` steps. The window's last step is k. The smoothed state's error is correlated with
    the noise of the inputs in the window. For the input i steps after s, this correlation is
    L_i P_{s+i|k}, where P_{s+i|k} is a smoothed covariance and L_i = C_s ... C_{s+i-1} is a product
    of the smoother's gains C. The smoothed state's error is not correlated with the noise of inputs
    after the window.

    Parameters
    ----------
    filtered, predicted
        The filtered and the predicted covariance of each step of the window, oldest first. Each
        has the shape (4, 4): position, velocity, acceleration and bias.
    axis
        The filter's model for one axis.
    model
        The predictor's model of one IMU step; its states are position, velocity and bias.
    steps
        Number of IMU steps of the prediction. If 0, the newest filtered covariance is returned.
    """
    if steps == 0:
        return filtered[-1][:2, :2]
    A = axis.model.A
    gains = [P @ A.T @ np.linalg.inv(Pm) for P, Pm in zip(filtered, predicted[1:], strict=False)]
    smoothed = [filtered[-1]]
    for P, Pm, C in zip(filtered[-2::-1], predicted[:0:-1], gains[::-1], strict=True):
        smoothed.insert(0, P + C @ (smoothed[0] - Pm) @ C.T)
    noise = prediction_noise(model, steps)
    T, D = noise.transition, noise.response
    cross, L = np.zeros((4, 3)), np.eye(4)
    for i in range(min(len(smoothed), steps)):
        cross += np.outer(L @ smoothed[i] @ axis.force_row, D[i])
        if i < len(gains):
            L = L @ gains[i]
    mixed = T @ cross[SIGMA_2_STATES]
    result = T @ smoothed[0][np.ix_(SIGMA_2_STATES, SIGMA_2_STATES)] @ T.T + mixed + mixed.T
    result += noise.process + axis.force_variance * D.T @ D
    return np.asarray(result[:2, :2])
