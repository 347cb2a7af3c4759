"""The multirate Kalman filter as in Algorithm 6, by filterpy: two axes, 8 states."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.models import POSITION, AxisFilter

_I = np.eye(2)


class FilterStep(NamedTuple):
    """What Algorithm 6 returns, and the innovation of the position.

    States are (8,), covariances (8, 8); the innovation is (2,), its covariance (2, 2).
    """

    x: Array
    P: Array
    x_predicted: Array
    P_predicted: Array
    innovation: Array
    innovation_covariance: Array


class MultirateKalmanFilter:
    """The filter on Sigma_1 or Sigma_2; states (x, y, v_x, v_y, a_x, a_y, b_x, b_y).

    The yaw enters through H. The paper prints P_0 = I_6 and registers for 9 states, but Sigma_1 has
    8. Sigma_2 runs on 8 states too: its acceleration is a white state that is not observed and does
    not affect the other states.
    """

    def __init__(self, axis: AxisFilter, rotation: Array, rule: str) -> None:
        from filterpy.kalman import KalmanFilter

        self.rule = rule
        self.rotation = rotation
        self.takes_input = not np.any(axis.force_row)
        self.kf = KalmanFilter(dim_x=8, dim_z=4, dim_u=2)
        self.kf.F = np.kron(axis.model.A, _I)
        self.kf.B = np.kron(axis.model.B, _I)
        self.kf.Q = np.kron(axis.model.Q, _I)
        self.kf.P = np.kron(axis.initial_covariance, _I)
        self.position_rows = np.kron(POSITION, _I)
        self.force_rows = rotation.T @ np.kron(axis.force_row, _I)  # (6b): R'(x3 - x4)
        self.R_position = axis.position_variance * _I
        self.R_force = axis.force_variance * _I
        self.previous_input = np.zeros((2, 1))

    def step(self, force: Array, fix: Array | None, held_fix: Array | None = None) -> FilterStep:
        """Predict, then correct with this step's specific force (IMU frame) and fix.

        `held_fix` is the last fix. Only the rule `mask_rows` uses it, as Algorithm 6 is printed.
        """
        kf = self.kf
        kf.predict(u=self.previous_input)
        self.previous_input = self.rotation @ force.reshape(2, 1)
        x_predicted, P_predicted = kf.x.copy(), kf.P.copy()
        if fix is not None:
            innovation = fix - x_predicted[:2, 0]
        else:
            innovation = np.zeros(2)
        S = self.position_rows @ P_predicted @ self.position_rows.T + self.R_position
        if self.rule == "proper" or fix is not None:
            self._correct(force, fix)
        elif self.rule == "every_step":
            self._correct(force, x_predicted[:2, 0])  # the innovation is zero
        else:
            self._masked(force, held_fix)
        return FilterStep(
            kf.x[:, 0].copy(), kf.P.copy(), x_predicted[:, 0], P_predicted, innovation, S
        )

    def _correct(self, force: Array, fix: Array | None) -> None:
        """Correct with the available measurements by filterpy's update (Joseph form)."""
        rows, values, noise = [], [], []
        if fix is not None:
            rows.append(self.position_rows)
            values.append(fix)
            noise.append(self.R_position)
        if not self.takes_input:
            rows.append(self.force_rows)
            values.append(force)
            noise.append(self.R_force)
        if not rows:
            return
        R = np.kron(np.eye(len(rows)), _I)
        for i, block in enumerate(noise):
            R[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
        self.kf.update(np.concatenate(values).reshape(-1, 1), R=R, H=np.vstack(rows))

    def _masked(self, force: Array, held_fix: Array | None) -> None:
        """Correct between fixes by Algorithm 6, lines 5-10: part of K is zero, P = (I - K H) P."""
        kf = self.kf
        H = np.vstack([self.position_rows, self.force_rows])
        R = np.block([[self.R_position, np.zeros((2, 2))], [np.zeros((2, 2)), self.R_force]])
        if self.takes_input:
            H, R = H[:2], R[:2, :2]
        K = kf.P @ H.T @ np.linalg.inv(H @ kf.P @ H.T + R)
        z = np.concatenate([kf.x[:2, 0], force])[: len(H)]
        if self.rule == "mask_columns":
            K[:, :2] = 0.0
        else:
            K[:2] = 0.0
            if held_fix is not None:
                z[:2] = held_fix
        kf.x = kf.x + K @ (z.reshape(-1, 1) - H @ kf.x)
        P = (np.eye(8) - K @ H) @ kf.P
        kf.P = 0.5 * (P + P.T)  # a covariance is symmetric
