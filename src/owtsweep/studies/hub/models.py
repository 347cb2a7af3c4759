"""The two process models of Ren et al. (2019), section 3, and filters made of them by a tuning.

Noise covariances are equal in all directions and the yaw is known, so both models separate into two
equal axes in NED. The models of one axis have the states p, v, a and b (position, velocity,
acceleration, and b = x4 of Eq. 6). The matrices of two axes are kron(axis, I_2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete, Model, discretise
from owtsweep.estimation.gains import RULES
from owtsweep.estimation.riccati import TwoRates
from owtsweep.estimation.weighing import ALIKE, Weighing
from owtsweep.gravity import GRAVITY
from owtsweep.studies.hub.scheme_sections import FilterTuning, FixTuning, Variance
from owtsweep.studies.hub.sensors import Sensors

POSITION = np.array([1.0, 0.0, 0.0, 0.0])
#: The specific force is R f = x3 - x4, Eq. (6b).
FORCE = np.array([0.0, 0.0, 1.0, -1.0])
#: Indices of Sigma_2's states (p, v, b) among the four states.
SIGMA_2_STATES = np.array([0, 1, 3])


def variance(rule: Variance, sigma: float, sensors: Sensors) -> float:
    """Compute the variance of a measurement by a rule from the standard deviation of its sensor."""
    factor = {
        "sigma2": 1.0,
        "sigma2_over_step": 1.0 / sensors.step,
        "sigma2_times_ratio": float(sensors.fix_interval),
    }[rule.rule]
    return math.prod((sigma, sigma, factor, rule.scale))


def sigma_1(q_a: float, q_b: float) -> Model:
    """Return the model Sigma_1 of one axis, Eq. (6a) of Ren et al. (2019).

    The states are position, velocity, acceleration and bias; there is no input. In Eq. (6a) white
    noise drives only the bias. The text of the paper says that white noise drives the acceleration
    too, so Q contains q_a, in (m/s^3)^2/Hz, as well as q_b, in (m/s^2)^2/s.
    """
    A = np.diag([1.0, 1.0, 0.0], k=1)
    return Model(A=A, B=np.zeros((4, 1)), Q=np.diag([0.0, 0.0, q_a, q_b]))


def sigma_2(q_f: float, q_b: float, lean: float = 0.0) -> Model:
    """Return the model Sigma_2 of one axis, Eq. (8a) of Ren et al. (2019).

    The states are position, velocity and bias; the input is the specific force u = R f. q_f, in
    (m/s^2)^2/Hz, is the density of the accelerometer's noise. q_b, in (m/s^2)^2/s, is the density
    of the bias' walk. Q is the paper's E Q E'. With `lean`, in s^-2, which the paper has not
    (section 3, assumption 2), the IMU leans as it moves: f = a - lean p, so v' = u + b + lean p.
    """
    A = np.eye(3, k=1)
    A[1, 0] = lean
    return Model(A=A, B=np.array([[0.0], [1.0], [0.0]]), Q=np.diag([0.0, q_f, q_b]))


def four_states(model: Discrete) -> Discrete:
    """Extend a model of position, velocity and bias by the acceleration, the third of four states.

    It is white noise of variance 1 and affects no other state.
    """
    spread = np.eye(4)[:, SIGMA_2_STATES]
    Q = spread @ model.Q @ spread.T
    Q[2, 2] = 1.0
    return Discrete(A=spread @ model.A @ spread.T, B=spread @ model.B, Q=Q, step=model.step)


@dataclass(frozen=True)
class AxisFilter:
    """The matrices and variances of one axis of a multirate Kalman filter.

    model: discrete model of four states; `model.B` is zero for Sigma_1.
    force_row: measurement row (4,) of the specific force in NED; zero for Sigma_2, where it is an
        input.
    position_variance, force_variance: of a position fix, m^2, and of an IMU sample, (m/s^2)^2.
    initial_covariance: covariance (4, 4) of the first state.
    """

    model: Discrete
    force_row: Array
    position_variance: float
    force_variance: float
    initial_covariance: Array

    def rates(self, rule: str) -> TwoRates:
        """Return the model with fixes as its slow measurement, IMU samples as its fast one.

        `rule`, one of `estimation.gains.RULES`, says how a step without a fix is treated.
        """
        return TwoRates(
            A=np.ascontiguousarray(self.model.A),
            Q=self.model.Q,
            slow=POSITION,
            fast=self.force_row,
            r_slow=self.position_variance,
            r_fast=self.force_variance,
            rule=RULES.index(rule),
        )


def axis_filter(tuning: FilterTuning, sensors: Sensors) -> AxisFilter:
    """Make the matrices and variances of a Kalman filter for one axis from tuning and sensors."""
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    force_variance = variance(tuning.r_imu, sensors.force_sigma, sensors)
    if tuning.model == "sigma1":
        model = discretise(sigma_1(tuning.q_a, q_b), sensors.step, tuning.discretisation)
        force_row = FORCE - GRAVITY * tuning.tilt * POSITION
    else:
        continuous = sigma_2(force_variance * sensors.step, q_b, GRAVITY * tuning.tilt)
        model = four_states(discretise(continuous, sensors.step, tuning.discretisation))
        force_row = np.zeros(4)
    return AxisFilter(
        model=model,
        force_row=force_row,
        position_variance=variance(tuning.r_gnss, sensors.position_sigma, sensors),
        force_variance=force_variance,
        initial_covariance=np.diag(tuning.p0),
    )


def make_fix_rule(tuning: FixTuning, name: str | None = None, axes: int = 2) -> Weighing:
    """Return how far a filter trusts a fix: always, only inside a gate, or less far out (Huber).

    The limit of a gate is the quantile of the chi distribution, with a degree of freedom per axis,
    at the key `gate_probability` (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).

    name: the rule; None: the key `fix_rule`.
    axes: number of axes of which a fix is judged at once, 1 or 2.
    """
    name = name or tuning.fix_rule
    if name == "gate":
        if axes == 1:
            limit = NormalDist().inv_cdf(0.5 + 0.5 * tuning.gate_probability)
        else:
            limit = math.sqrt(-2.0 * math.log1p(-tuning.gate_probability))
        return Weighing(limit, False, tuning.gate_patience)
    return Weighing(tuning.huber_limit, True, 0) if name == "huber" else ALIKE


def input_model(tuning: FilterTuning, sensors: Sensors, hold: str) -> Discrete:
    """Return the predictor's model: Sigma_2 of Ren et al. (2019), discretised over one IMU step.

    The specific force has no noise. `hold` is one of `estimation.discretisation.HOLDS`.
    """
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    model = sigma_2(0.0, q_b, GRAVITY * tuning.tilt)
    return discretise(model, sensors.step, tuning.discretisation, hold=hold)
