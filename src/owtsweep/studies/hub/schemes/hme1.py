"""HME1: a scheme of register 1, multirate Kalman filter, online smoother and predictor.

Register 1 delays the samples of the IMU by the delay of the GNSS. Source: Algorithm 1 of Ren et al.
(2019).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import predict, prediction_noise
from owtsweep.estimation.gains import FixedLagSmoother
from owtsweep.estimation.weighing import ALIKE
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import Parts
from owtsweep.studies.hub.checks import check_window
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Estimator, Known
from owtsweep.studies.hub.horizon import Horizon
from owtsweep.studies.hub.models import SIGMA_2_STATES, axis_filter, input_model, make_fix_rule
from owtsweep.studies.hub.schemes.chained import FilterScheme
from owtsweep.studies.hub.schemes.multirate import FilterStep, MultirateKalmanFilter
from owtsweep.studies.hub.sensors import Sensors


class HME1Estimator:
    """HME1 as an estimator that runs step by step: Algorithm 1 of Ren et al. (2019).

    Register 1 delays the samples of the IMU; filter, smoother and predictor follow. As long as
    every fix arrives when it is due, the covariances of estimates are taken from `gains`, the
    scheme as a chain. After that, `on_schedule` is False, and the covariances are computed from the
    filter's own past covariances.
    """

    def __init__(self, known: Known, scheme: HME1) -> None:
        sensors, parts = known.sensors, scheme.find_parts(known)
        assert parts.predict is not None
        self.parts, self.sensors, self.input_model = parts, sensors, parts.predict
        self.gains = scheme.find_gains(known)
        self.on_schedule = parts.fix_rule == ALIKE
        self.filter = MultirateKalmanFilter(parts, sensors.rotation)
        self.smoother = FixedLagSmoother(self.filter.kf.F, parts.window)
        self.count = 0
        # Register 1 delays samples by N_d steps (the GNSS delay); the paper prints N_d - 1.
        # Register u_s keeps the last N_s samples that have left register 1; N_s is the length of
        # the smoother's window. Both registers start with zeros.
        kept = parts.ahead + 1
        self.samples: deque[Array] = deque([np.zeros(2)] * kept, maxlen=kept)

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        if (position is not None) != (self.count % self.sensors.fix_interval == 0):
            self.on_schedule = False
        return self.advance(self.push(specific_force), position)[0]

    def push(self, specific_force: Array) -> Array:
        """Store the newest IMU sample in register 1; return the sample of N_d steps ago.

        N_d is the delay of the GNSS. Samples are in the IMU's frame, in m/s^2, shape (2,).
        """
        # a copy, because the caller may reuse its array
        self.samples.append(np.array(specific_force, dtype=float))
        return self.samples[-1 - self.sensors.delay]

    def advance(self, delayed: Array, fix: Array | None) -> tuple[Estimate, FilterStep]:
        """Filter, smooth and predict (Algorithms 6 to 9 of Ren et al. 2019).

        Return the estimate of the present motion, and the filter's results, which are for N_d steps
        ago.

        delayed: the IMU sample of N_d steps ago, as `push` returns it.
        fix: the position of N_d steps ago, in NED, in m, shape (2,); None if the filter gets none.
        """
        step = self.filter.step(delayed, fix)
        smoothed = self.smoother.update(step.x, step.P, step.x_predicted, step.P_predicted)
        state: Array = np.zeros(8) if smoothed is None else smoothed[0]
        inputs = np.array(self.samples) @ self.sensors.rotation.T
        if self.input_model.B_next is None:  # held: the newest sample acts after the present
            inputs = inputs[:-1]
        start = np.array([state[:2], state[2:4], state[6:8]])  # x1, x2, x4 of both axes
        now = np.array([predict(self.input_model, start[:, i], inputs[:, [i]]) for i in range(2)])
        covariance = np.kron(self._covariance(full=smoothed is not None), np.eye(2))
        self.count += 1
        return Estimate(now[:, 0], now[:, 1], covariance, step.innovation), step

    def _covariance(self, *, full: bool) -> Array:
        if self.on_schedule or not full:
            return np.asarray(self.gains.covariance[int(self.gains.gains.row(self.count))])
        return self._predict_covariance()

    def _predict_covariance(self) -> Array:
        """Compute the covariance of the predicted position and velocity along an axis, (2, 2).

        The prediction starts from the smoothed state of the oldest step s of the smoother's window.
        The window's last step is k. The smoothed state's error is correlated with the noise of the
        inputs in the window. For the input i steps after s, this correlation is L_i P_{s+i|k},
        where P_{s+i|k} is a smoothed covariance and L_i = C_s ... C_{s+i-1} is a product of the
        smoother's gains C. It is not correlated with the noise of inputs after the window.
        """
        # covariances (4, 4) of each step of the window, oldest first
        past = self.smoother.register
        filtered, predicted = ([entry[i][::2, ::2] for entry in past] for i in (1, 3))
        axis, steps = self.parts.axis, self.parts.ahead
        if steps == 0:
            return filtered[-1][:2, :2]
        A = axis.model.A
        pairs = zip(filtered, predicted[1:], strict=False)
        gains = [P @ A.T @ np.linalg.inv(Pm) for P, Pm in pairs]
        smoothed = [filtered[-1]]
        for P, Pm, C in zip(filtered[-2::-1], predicted[:0:-1], gains[::-1], strict=True):
            smoothed.insert(0, P + C @ (smoothed[0] - Pm) @ C.T)
        noise = prediction_noise(self.input_model, steps)
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


class HME1(FilterScheme):
    """The scheme HME1 (hub motion estimator 1 of Ren et al. 2019)."""

    name = "HME1"
    sections: Sequence[str] = ("hme1", "hme.smoother_window", "hme.predictor")

    def start(self, known: Known) -> Estimator:
        return HME1Estimator(known, self)

    def choose_window(self, tuning: HubConfig) -> int:
        """Return the smoother's window, in IMU steps."""
        return tuning.hme.smoother_window

    def make_horizon(self, tuning: HubConfig, sensors: Sensors) -> Horizon | None:
        """Return the MHE between fixes and filter, if there is one."""
        return None

    def find_parts(self, known: Known) -> Parts:
        sensors, tuning = known.sensors, known.tuning
        of_filter = self.choose_filter(tuning)
        horizon = self.make_horizon(tuning, sensors)
        return Parts(
            axis_filter(of_filter, sensors),
            of_filter.update_rule,
            # an MHE weighs the fixes itself; the filter then takes its positions as they are
            make_fix_rule(of_filter) if horizon is None else ALIKE,
            sensors.delay,
            self.choose_window(tuning),
            input_model(of_filter, sensors, tuning.hme.predictor.hold),
            horizon,
        )

    def check(self, config: HubConfig) -> None:
        check_window(config, "hme.smoother_window", config.hme.smoother_window)


SCHEME = HME1()
