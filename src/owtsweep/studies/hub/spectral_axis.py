"""Makes the model of SKF along one axis, and its gains: a motion of known spectrum and variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Model, discretise
from owtsweep.estimation.late_gains import (
    LateGains,
    LateModel,
    find_first_covariance,
    schedule_late,
)
from owtsweep.motion.shaping import ShapingFilter
from owtsweep.studies.hub.known import Sensors
from owtsweep.studies.hub.scheme_sections import Skf

#: Longest transient that is stored, in steps (2621 s at 100 Hz); then the last cycle is repeated.
LONGEST_TRANSIENT = 2**18


@dataclass(frozen=True, eq=False)
class SpectralAxis:
    """The model of SKF along one axis.

    Attributes
    ----------
    model
        The model in discrete time. Its fast measurement is the specific force, its slow one a fix.
    first
        Covariance (N, N) of the state one step before step 0.
    outputs
        Rows (2, n) of position and velocity.
    """

    model: LateModel
    first: Array
    outputs: Array


def make_axis(
    shaping: ShapingFilter, variance: float, tuning: Skf, sensors: Sensors
) -> SpectralAxis:
    """Make the model of one axis from the spectrum, as a shaping filter, and the variance.

    The specific force along the axis is f = a - g tilt p + b + noise, with acceleration a, position
    p and bias b, which includes gravity; see `Sensors.lean`. The IMU's white noise and the noise of
    fixes have the sensors' own variances.

    Parameters
    ----------
    shaping
        The spectrum, of n states, for motion with a variance of 1 m^2.
    variance
        Variance of the motion along the axis, m^2.
    tuning
        The section `skf` of the configuration.
    sensors
        The properties of IMU and GNSS.
    """
    from scipy.linalg import solve_continuous_lyapunov

    n, step, delay = len(shaping.A), sensors.step, sensors.delay
    intensity = variance * np.outer(shaping.B, shaping.B)
    discrete = discretise(Model(shaping.A, np.zeros((n, 1)), intensity), step)
    blocks = np.array([discrete.A[i : i + 2, i : i + 2] for i in range(0, n, 2)])
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    model = LateModel(
        A=blocks,
        Q=discrete.Q,
        walk=q_b * step,
        fast=shaping.acceleration - tuning.find_lean(sensors.lean) * shaping.position,
        slow=shaping.position.copy(),
        r_fast=sensors.force_sigma**2,
        r_slow=sensors.position_sigma**2,
        interval=sensors.fix_interval,
        delay=delay,
        copies=-(-delay // sensors.fix_interval),
    )
    stationary = solve_continuous_lyapunov(shaping.A, -intensity)
    first = find_first_covariance(model, stationary, tuning.bias_variance)
    return SpectralAxis(model, first, np.stack([shaping.position, shaping.velocity]))


@dataclass(frozen=True, eq=False)
class TunedAxis:
    """The model of SKF along one axis, with its gains for every step.

    Attributes
    ----------
    axis
        The model.
    gains
        The gains, and the covariances of position and velocity.
    precision
        Elements pp, pv, vv of the inverse of each of these covariances, shape (rows, 3).
    """

    axis: SpectralAxis
    gains: LateGains
    precision: Array


def tune_axis(axis: SpectralAxis, steps: int) -> TunedAxis:
    """Compute the gains of an axis for records of up to `steps` IMU steps."""
    gains = schedule_late(axis.model, axis.first, axis.outputs, min(steps, LONGEST_TRANSIENT))
    pp, pv, vv = gains.covariance[:, [0, 0, 1], [0, 1, 1]].T
    precision = np.stack([vv, -pv, pp], axis=1) / (pp * vv - pv * pv)[:, None]
    return TunedAxis(axis, gains, precision)
