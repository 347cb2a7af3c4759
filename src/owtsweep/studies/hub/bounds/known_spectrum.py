"""Computes the least error of an estimator that knows the motion's spectrum and variance.

The motion is a shaping filter's, driven by white noise; the IMU's bias is a random walk. Of all
linear estimators with these sensors, the Kalman filter of this model has the least mean square
error (with Gaussian motion and noise: of all estimators). The state holds a copy of the position
from the time of each fix that is under way, and the fix is a measurement of the copy. In the steady
state, the filter's covariance repeats with the interval between fixes; the bound is its mean over
that interval.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Model, discretise
from owtsweep.estimation.periodic import find_steady_covariance, make_prediction, make_update
from owtsweep.motion.shaping import ShapingFilter
from owtsweep.studies.hub.horizon import LEAST_BIAS_DENSITY
from owtsweep.studies.hub.sensors import Sensors


def bound_of_known_spectrum(
    shape: ShapingFilter, variance: float, sensors: Sensors
) -> tuple[float, float]:
    """Compute the bounds along one axis, of position (m^2) and of velocity ((m/s)^2).

    shape: the spectrum of the motion, as a filter.
    variance: of the position along the axis, m^2.
    sensors: their AC coupling and scale of a fix are left out.
    """
    states = len(shape.B)
    copies = sensors.delay // sensors.fix_interval + 1
    n = states + 1 + copies  # the motion, the bias, copies of the position (the newest first)
    A, Q = np.zeros((n, n)), np.zeros((n, n))
    A[:states, :states] = shape.A
    Q[:states, :states] = variance * np.outer(shape.B, shape.B)
    Q[states, states] = max(sensors.bias_walk**2, LEAST_BIAS_DENSITY)
    model = discretise(Model(A, np.zeros((n, 1)), Q), sensors.step)
    felt = shape.acceleration - sensors.lean * shape.position  # by an IMU that may lean
    position, velocity, force = (
        np.pad(row, (0, n - states)) for row in (shape.position, shape.velocity, felt)
    )
    force[states] = 1.0
    oldest = np.eye(n)[-1]
    copying = np.eye(n)
    copying[states + 1 :] = np.eye(n)[states : n - 1]
    copying[states + 1] = position

    predict = make_prediction(model.A, model.Q)
    copy = make_prediction(copying, np.zeros((n, n)))
    fix = make_update(oldest, sensors.position_sigma**2)
    sample = make_update(force, sensors.force_sigma**2)
    # A fix that arrives at step 0 is about step -delay; steps are counted within the interval.
    copied_at = -sensors.delay % sensors.fix_interval
    step = sample.then(predict)
    first = (copy.then(fix) if copied_at == 0 else fix).then(step)
    if copied_at == 0:
        period = first.then(step.repeat(sensors.fix_interval - 1))
    else:
        ahead = first if copied_at == 1 else first.then(step.repeat(copied_at - 1))
        period = ahead.then(copy).then(step.repeat(sensors.fix_interval - copied_at))
    P = find_steady_covariance(period)
    total = np.zeros(2)
    for index in range(sensors.fix_interval):
        if index == copied_at:
            P = copy.apply(P)
        if index == 0:
            P = _update(P, oldest, sensors.position_sigma**2)
        P = _update(P, force, sensors.force_sigma**2)
        total += position @ P @ position, velocity @ P @ velocity
        P = model.A @ P @ model.A.T + model.Q
    mean = total / sensors.fix_interval
    return float(mean[0]), float(mean[1])


def _update(P: Array, row: Array, variance: float) -> Array:
    """Return the covariance (n, n) after a measurement `row` x + v, where v has `variance`."""
    seen = P @ row
    return np.asarray(P - np.outer(seen, seen) / (row @ seen + variance))
