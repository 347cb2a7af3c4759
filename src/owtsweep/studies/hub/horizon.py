"""The settings of HME2's MHE as numbers, for all engines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Discrete, discretise
from owtsweep.estimation.gains import GainSchedule
from owtsweep.estimation.mhe import WindowWeights, window_maps
from owtsweep.estimation.weighing import ALIKE, Weighing
from owtsweep.studies.hub.kernels.layout import NO_LEAN, HorizonArrays, LeanTerms
from owtsweep.studies.hub.models import SIGMA_2_STATES, sigma_2, variance
from owtsweep.studies.hub.scheme_sections import Mhe
from owtsweep.studies.hub.sensors import Sensors

INPUTS = ("all", "averaged", "sampled")

#: Least density of the bias walk, (m/s^2)^2/s: a link's covariance must not be singular.
LEAST_BIAS_DENSITY = 1e-12


@dataclass(frozen=True)
class Horizon:
    """The MHE along one axis, with the states position, velocity, bias.

    interval: T_m, the time between two positions that the MHE gives to the filter, in IMU steps.
    length: N_m, the number of GNSS intervals in the window.
    first: number (from 0) of the first fix at which the window can be solved. Until then the filter
        gets the fixes themselves.
    arrival: whether the window has an arrival term: a prior of its oldest state, made from the
        filter's past state.
    fixed: whether the window's oldest state is set equal to the filter's past state.
    inputs: which IMU samples the MHE takes, one of `INPUTS`.
    weights: of Eq. (11a) of Ren et al. (2019) for one GNSS interval.
    initial_covariance: covariance (3, 3) of the prior while the window fills
        (only with an arrival term).
    bounds: largest allowed magnitudes (3,) of position and velocity, per axis in NED, and of the
        bias b^b, per axis in the IMU's frame; infinity means no bound. `arrays` ignores bounds.
    lean: the IMU's lean that the model assumes, s^-2.
    fix_rule: how much a fix counts that is far from its prediction; `arrays` ignores it.
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
    lean: float
    fix_rule: Weighing = ALIKE

    def arrays(self, gains: GainSchedule, sensors: Sensors) -> HorizonArrays:
        """Make the kernels' form of the MHE: one matrix per position fix, until matrices repeat.

        A matrix turns the window's data into the state at the newest fix.
        """
        M = sensors.fix_interval
        settled = -(-gains.rows // M) if self.arrival else 0
        count = self.length + settled + 1
        maps = np.zeros((count, 3, 4 * self.length + 4))
        for fix in range(self.first, self.length):  # there is a prior, or no arrival term
            covariance = self.arrival_covariance(fix, gains, M)
            (solution,) = window_maps(self.weights, fix, [covariance])
            maps[fix, :, : solution.shape[1]] = solution
        covariances = (
            None if self.fixed else self.arrival_covariance(fix, gains, M)
            for fix in range(self.length, count)
        )
        kind = {"fixed_arrival": self.fixed, "use_first_fix": not self.arrival}
        solutions = window_maps(self.weights, self.length, covariances, **kind)
        for fix, solution in enumerate(solutions, self.length):
            maps[fix] = solution
        return HorizonArrays(
            active=True,
            maps=maps,
            horizon=self.length,
            interval=self.interval,
            first=self.first,
            arrival=self.arrival,
            inputs=INPUTS.index(self.inputs),
            step=sensors.step,
            growth=growth_over(self.lean, sensors, M),
            lean=lean_terms(self.lean, sensors.step),
        )

    def uses_filter(self, fix: int) -> bool:
        """Return whether the window at fix number `fix` starts from a past state of the filter.

        It does if there is an arrival term and the window is full. The past state is x_m0 of
        register 3 (Algorithm 5 of Ren et al. 2019). It already includes the window's oldest fix, so
        the window leaves that fix out.
        """
        return self.arrival and fix >= self.length

    def arrival_covariance(self, fix: int, gains: GainSchedule, M: int) -> Array | None:
        """Return the covariance (3, 3) of the prior of the window at fix `fix`; None for none."""
        if not self.arrival:
            return None
        if not self.uses_filter(fix):
            return self.initial_covariance
        P = gains.filtered[gains.row((fix - self.length) * M)]
        return np.asarray(P[np.ix_(SIGMA_2_STATES, SIGMA_2_STATES)])


def horizon(tuning: Mhe, sensors: Sensors, lean: float = 0.0) -> Horizon:
    """Turn the tuning of the MHE into numbers for given sensors; `lean`, s^-2, as in `sigma_2`."""
    q_f = sensors.force_sigma**2 * sensors.step if tuning.q_a is None else tuning.q_a
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    model = discretise(sigma_2(q_f, max(q_b, LEAST_BIAS_DENSITY), lean), sensors.fix_step)
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
        lean=lean,
    )


def transition_over(seconds: float, lean: float = 0.0) -> Array:
    """Return the exact transition matrix (3, 3) of position, velocity and bias over a time (s).

    The paper has I + t_f A (A_df in Eq. (11g) of Ren et al. 2019). `lean`, s^-2, as in `sigma_2`.
    """
    if lean == 0.0:
        return np.array([[1.0, seconds, 0.5 * seconds**2], [0.0, 1.0, seconds], [0.0, 0.0, 1.0]])
    return discretise(sigma_2(0.0, 0.0, lean), seconds).A


def growth_over(lean: float, sensors: Sensors, steps: int) -> Array:
    """Return what a state adds to position and velocity, beside itself, k steps later.

    The result has the shape (steps, 2, 3): k, what is added to (position, velocity), and by which
    state (position, velocity, bias).
    """
    result = np.empty((steps, 2, 3))
    for k in range(steps):
        t = k * sensors.step
        if lean == 0.0:
            result[k] = [[0.0, t, 0.5 * t * t], [0.0, 0.0, t]]
        else:
            result[k] = (transition_over(t, lean) - np.eye(3))[:2]
    return result


def lean_terms(lean: float, step: float) -> LeanTerms:
    """Return what a lean, in s^-2, changes in one step (s) of integrating an input twice."""
    if lean == 0.0:
        return NO_LEAN
    return find_lean_terms(discretise(sigma_2(0.0, 0.0, lean), step), 0.5 * step * step)


def find_lean_terms(model: Discrete, half: float) -> LeanTerms:
    """Return the terms by which Sigma_2 over one step differs from integrating an input twice.

    `half` is what a unit of input adds to the position besides, s^2.
    """
    A, B, step = model.A, model.B[:, 0], model.step
    return LeanTerms(
        pp=A[0, 0] - 1.0,
        pv=A[0, 1] - step,
        pu=B[0] - half,
        vp=A[1, 0],
        vv=A[1, 1] - 1.0,
        vu=float(B[1]) - step,
    )
