"""Computes the Kalman bound: the least error of an estimator that assumes nothing about the motion.

Such an estimator's error is the same whatever the motion. So the motion is the model Sigma_2
(position, velocity, bias) with the IMU's sample as the input and the sample's noise and the bias
walk as the only process noise. Of all linear estimators without an assumption about the motion, the
Kalman filter of this model has the least mean square error; with Gaussian noise, of all estimators.
The filter runs at the fixes' own time, and the samples since then carry its state to the present.

The bound holds in the steady state. Two things may lie below it: a scheme that assumes that the
motion is small (MKF at small amplitudes), and the mean over a few records, by chance.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.discretisation import discretise
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.horizon import LEAST_BIAS_DENSITY
from owtsweep.studies.hub.models import sigma_2
from owtsweep.studies.hub.sensors import Sensors


def kalman_bound(config: HubConfig) -> float:
    """Compute the bound of the MSE that the key `measures.criterion` names, m^2 or (m/s)^2."""
    return kalman_bounds(config)[config.measures.criterion]


def kalman_bounds(config: HubConfig) -> dict[str, float]:
    """Compute measure -> bound of its MSE, m^2 or (m/s)^2, for the sensors of a configuration."""
    position, velocity = bound_of_axis(sensing.sensors(config.sensors))
    return {"position": 2.0 * position, "velocity": 2.0 * velocity, "x": position, "y": position}


def bound_of_axis(sensors: Sensors) -> tuple[float, float]:
    """Compute the bounds along one axis, of position (m^2) and of velocity ((m/s)^2).

    They are means over the time between two fixes. Raises InputError if the sensors' numbers differ
    too much in magnitude to compute with.
    """
    from scipy.linalg import solve_discrete_are

    q_b = max(sensors.bias_walk**2, LEAST_BIAS_DENSITY)
    model = discretise(sigma_2(0.0, q_b, sensors.lean), sensors.step)
    noise = model.Q + sensors.force_sigma**2 * model.B @ model.B.T
    A, Q = _over(model.A, noise, sensors.fix_interval)
    H = np.array([[1.0, 0.0, 0.0]])
    R = np.array([[sensors.position_sigma**2]])
    try:
        before = solve_discrete_are(A.T, H.T, Q, R)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"sensors: the Kalman bound cannot be computed for noise of {sensors.position_sigma:g} "
            f"m (GNSS) and {sensors.force_sigma:g} m/s^2 (IMU) with a bias walk of "
            f"{sensors.bias_walk:g} m/s^2/sqrt(s); use less extreme values"
        ) from error
    gain = before @ H.T / (before[0, 0] + R[0, 0])
    P: Array = before - gain @ H @ before
    A_delay, Q_delay = _over(model.A, noise, sensors.delay)
    errors = []
    for _ in range(sensors.fix_interval):
        errors.append(np.diagonal(A_delay @ P @ A_delay.T + Q_delay))
        P = model.A @ P @ model.A.T + noise
    position, velocity, _ = np.mean(errors, axis=0)
    return float(position), float(velocity)


def _over(A: Array, Q: Array, steps: int) -> tuple[Array, Array]:
    """Return transition matrix and noise covariance over several steps of one step's A and Q."""
    transition, covariance = np.eye(len(A)), np.zeros_like(Q)
    for _ in range(steps):
        transition, covariance = A @ transition, A @ covariance @ A.T + Q
    return transition, covariance
