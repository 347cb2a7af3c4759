"""The settings of HME2's moving horizon estimator as numbers, for both engines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import discretise
from owtsweep.estimation.gains import GainSchedule
from owtsweep.estimation.mhe import WindowWeights, window_map
from owtsweep.studies.hub.config import Mhe
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.kernels.layout import HorizonArrays
from owtsweep.studies.hub.models import SIGMA_2_STATES, sigma_2, variance

INPUTS = ("all", "averaged", "sampled")

#: Least density of the bias walk, (m/s^2)^2/s: a link's covariance must not be singular.
LEAST_BIAS_DENSITY = 1e-12


@dataclass(frozen=True)
class Horizon:
    """One axis of the MHE (states p, v, b).

    Attributes
    ----------
    interval
        Steps of T_m.
    length
        N_m, GNSS intervals in the window.
    first
        Number of the first fix at which the window can be solved. Until then the filter gets the
        fixes themselves.
    arrival
        Whether the filter's past state enters as arrival term.
    fixed
        Whether the oldest node's state equals that state; otherwise that state is its prior.
    inputs
        One of `INPUTS`.
    weights
        Weights of Eq. (11a) for one GNSS interval.
    initial_covariance
        (3, 3): covariance of the prior while the window fills (only with an arrival term).
    bounds
        (3,): of |p|, |v| (NED) and |b^b| (IMU's frame), infinite where there is none. The maps
        below ignore them.
    """

    interval: int
    length: int
    first: int
    arrival: bool
    fixed: bool
    inputs: str
    weights: WindowWeights
    initial_covariance: Array
    bounds: Array

    def arrays(self, gains: GainSchedule, sensors: Sensors) -> HorizonArrays:
        """The maps of all fixes until they repeat, for the kernels."""
        M = sensors.fix_interval
        settled = -(-gains.rows // M) if self.arrival else 0
        count = self.length + settled + 1
        maps = np.zeros((count, 3, 4 * self.length + 4))
        for fix in range(self.first, count):
            fixed = self.fixed and self.uses_filter(fix)  # while the window fills, there is a prior
            solution = window_map(
                self.weights,
                min(fix, self.length),
                arrival_covariance=None if fixed else self.arrival_covariance(fix, gains, M),
                fixed_arrival=fixed,
                use_first_fix=not self.uses_filter(fix),
            )
            maps[fix, :, : solution.shape[1]] = solution
        return HorizonArrays(
            active=True,
            maps=maps,
            horizon=self.length,
            interval=self.interval,
            first=self.first,
            arrival=self.arrival,
            inputs=INPUTS.index(self.inputs),
            step=sensors.step,
        )

    def uses_filter(self, fix: int) -> bool:
        """Whether the arrival state is the filter's (x_m0 of register 3, Algorithm 5).

        That state already includes the oldest fix, so the window leaves this fix out.
        """
        return self.arrival and fix >= self.length

    def arrival_covariance(self, fix: int, gains: GainSchedule, M: int) -> Array | None:
        """Covariance of the arrival state for the window whose newest fix is number `fix`."""
        if not self.arrival:
            return None
        if not self.uses_filter(fix):
            return self.initial_covariance
        P = gains.filtered[gains.row((fix - self.length) * M)]
        return np.asarray(P[np.ix_(SIGMA_2_STATES, SIGMA_2_STATES)])


def horizon(tuning: Mhe, sensors: Sensors) -> Horizon:
    """The MHE for a tuning and these sensors."""
    q_f = sensors.force_sigma**2 * sensors.step if tuning.q_a is None else tuning.q_a
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    model = discretise(sigma_2(q_f, max(q_b, LEAST_BIAS_DENSITY)), sensors.fix_step)
    link = model.Q if tuning.weights == "full" else np.diag(np.diagonal(model.Q))
    arrival = tuning.arrival in ("mkf", "fixed")
    return Horizon(
        interval=round(tuning.interval / sensors.step),
        length=tuning.horizon,
        first=0 if arrival else 2,
        arrival=arrival,
        fixed=tuning.arrival == "fixed",
        inputs=tuning.inputs,
        weights=WindowWeights(
            transition=model.A,
            link_covariance=link,
            fix_variance=variance(tuning.r_fix, sensors.position_sigma, sensors),
        ),
        initial_covariance=np.diag(tuning.p0),
        bounds=np.array(tuning.bounds),
    )


def transition_over(seconds: float) -> Array:
    """A_df of Sigma_2 on (p, v, b) over t_f, Eq. (11g); exact, where the paper has I + t_f A."""
    return np.array([[1.0, seconds, 0.5 * seconds**2], [0.0, 1.0, seconds], [0.0, 0.0, 1.0]])
