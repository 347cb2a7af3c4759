"""The multirate Kalman filter on two axes, with 8 states, by filterpy.

Source: Algorithm 6 of Ren et al. (2019).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.weighing import weigh
from owtsweep.evaluation.estimate import Innovation
from owtsweep.studies.hub.chain import Parts
from owtsweep.studies.hub.models import POSITION

_I = np.eye(2)


class FilterStep(NamedTuple):
    """The results of one step of the multirate Kalman filter (Algorithm 6 of Ren et al. 2019).

    States have the shape (8,), covariances (8, 8). This step's measurements have not been applied
    to `x_predicted` and `P_predicted`. `innovation` is that of the position fix; None without one.
    """

    x: Array
    P: Array
    x_predicted: Array
    P_predicted: Array
    innovation: Innovation | None


class MultirateKalmanFilter:
    """The multirate Kalman filter on the model Sigma_1 or Sigma_2 of Ren et al. (2019).

    The states are x, y, v_x, v_y, a_x, a_y, b_x, b_y: position, velocity, acceleration and bias. In
    Sigma_1 the IMU is a measurement; yaw enters through the measurement matrix. In Sigma_2 the IMU
    is an input, turned to NED first. Sigma_2 runs on 8 states too: its acceleration is white noise
    that is not observed and does not affect the other states. The paper prints an initial
    covariance P_0 = I_6 and registers for 9 states, but Sigma_1 has 8 states.
    """

    def __init__(self, parts: Parts, rotation: Array) -> None:
        from filterpy.kalman import KalmanFilter

        self.axis, self.rule, self.rotation = parts.axis, parts.rule, rotation
        self.fix_rule, axis = parts.fix_rule, parts.axis
        #: Number of fixes in a row beyond the limit of their rule.
        self.beyond = np.zeros(1, dtype=np.int64)
        self.takes_input = not np.any(axis.force_row)
        self.kf = KalmanFilter(dim_x=8, dim_z=4, dim_u=2)
        self.kf.F = np.kron(axis.model.A, _I)
        self.kf.B = np.kron(axis.model.B, _I)
        self.kf.Q = np.kron(axis.model.Q, _I)
        self.kf.P = np.kron(axis.initial_covariance, _I)
        self.position_rows = np.kron(POSITION, _I)
        force_rows = rotation.T @ np.kron(axis.force_row, _I)  # (6b): R'(x3 - x4)
        self.H = np.vstack([self.position_rows, force_rows])
        self.previous_input = np.zeros((2, 1))
        # the last fix; only the rule `mask_rows` uses it, as Algorithm 6 is printed
        self.held_fix: Array = np.zeros(2)

    def step(self, force: Array, fix: Array | None) -> FilterStep:
        """Predict one IMU step, then correct with the step's measurements; return both results.

        `force` is in the IMU's frame, in m/s^2, shape (2,). `fix` is in NED, in m, shape (2,), or
        None.
        """
        kf = self.kf
        kf.predict(u=self.previous_input)
        self.previous_input = self.rotation @ force.reshape(2, 1)
        x_predicted, P_predicted = kf.x.copy(), kf.P.copy()
        innovation, variance = None, self.axis.position_variance
        if fix is not None:
            S = self.position_rows @ P_predicted @ self.position_rows.T
            S = S + self.axis.position_variance * _I
            innovation = Innovation(fix - x_predicted[:2, 0], S)
            weight = weigh(measure_distance(innovation), self.fix_rule, self.beyond)
            if weight > 0.0:
                self.held_fix = np.array(fix, dtype=float)
                variance += (1.0 / weight - 1.0) * S[0, 0]  # the innovation's becomes S / weight
            else:
                fix = None
        if self.rule == "proper" or fix is not None:
            self._correct(force, fix, variance)
        elif self.rule == "every_step":
            self._correct(force, x_predicted[:2, 0], variance)  # the innovation is zero
        else:
            self._masked(force)
        return FilterStep(
            kf.x[:, 0].copy(), kf.P.copy(), x_predicted[:, 0], P_predicted, innovation
        )

    def _correct(self, force: Array, fix: Array | None, variance: float) -> None:
        """Correct the state by filterpy (Joseph form), with the IMU sample and the fix, if any."""
        used = np.repeat([fix is not None, not self.takes_input], 2)
        if used.any():
            z = np.concatenate([np.zeros(2) if fix is None else fix, force])[used]
            R = np.diag(np.repeat([variance, self.axis.force_variance], 2)[used])
            self.kf.update(z.reshape(-1, 1), R=R, H=self.H[used])

    def _masked(self, force: Array) -> None:
        """Correct at a step without a fix, by Algorithm 6, lines 5 to 10, of Ren et al. (2019).

        The update rule says which part of the gain K is set to zero: with `mask_columns`, the
        columns of the position fix; with `mask_rows`, the rows of the estimated position. The
        corrected covariance is (I - K H) P as the paper prints it; H is the measurement matrix.
        """
        kf = self.kf
        H = self.H[:2] if self.takes_input else self.H
        R = np.diag(np.repeat([self.axis.position_variance, self.axis.force_variance], 2)[: len(H)])
        K = kf.P @ H.T @ np.linalg.inv(H @ kf.P @ H.T + R)
        z = np.concatenate([kf.x[:2, 0], force])[: len(H)]
        if self.rule == "mask_columns":
            K[:, :2] = 0.0
        else:
            K[:2] = 0.0
            z[:2] = self.held_fix
        kf.x = kf.x + K @ (z.reshape(-1, 1) - H @ kf.x)
        P = (np.eye(8) - K @ H) @ kf.P
        kf.P = 0.5 * (P + P.T)  # a covariance is symmetric


def measure_distance(innovation: Innovation) -> float:
    """Return the length of an innovation (2,) in its own standard deviations, e' S^-1 e's root."""
    e, S = innovation
    return float(np.sqrt(e @ np.linalg.solve(S, e)))
