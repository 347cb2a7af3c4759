"""Makes chains: linear schemes as arrays for the batch kernels.

Every linear scheme of the study is the same chain with some of the parts in brackets left out: [MHE
->] multirate Kalman filter [-> fixed-lag smoother] [-> predictor]. Its gains depend on sensors and
tuning, and serve all periods, amplitudes and records.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.discretisation import Discrete, powers, prediction_noise
from owtsweep.estimation.gains import GainSchedule, schedule, smoother_gains
from owtsweep.estimation.weighing import ALIKE, Weighing
from owtsweep.estimation.windowing import FilterRows, covariances
from owtsweep.studies.hub.horizon import Horizon, find_lean_terms
from owtsweep.studies.hub.kernels.layout import (
    NO_LEAN,
    FilterArrays,
    HorizonArrays,
    PredictorArrays,
)
from owtsweep.studies.hub.models import SIGMA_2_STATES, AxisFilter
from owtsweep.studies.hub.sensors import Sensors


def predictor_arrays(model: Discrete | None, steps: int, step: float) -> PredictorArrays:
    """Make the numbers by which the kernels predict over `steps` steps of `step` seconds.

    `model` is Sigma_2 over one step; None without a predictor.
    """
    if model is None or steps == 0:
        return PredictorArrays(0, step, 0.0, 0.0, 0.0, 0.0, 0.0)
    A = powers(model.A, steps)[steps]
    if model.B_next is not None:
        # x[k+1] - N u[k+1] = A (x[k] - N u[k]) + (B + A N) u[k], where N is B_next: a model of
        # x - N u whose input is held
        first, new = (A @ model.B_next)[:, 0], model.B_next[:, 0]
        held = replace(model, B=model.B + model.A @ model.B_next, B_next=None)
        return predictor_arrays(held, steps, step)._replace(
            new_p=float(new[0]),
            new_v=float(new[1]),
            first_p=float(first[0]),
            first_v=float(first[1]),
        )
    half = float(model.B[0, 0])
    arrays = PredictorArrays(
        steps=steps,
        step=step,
        half=half,
        pv=A[0, 1],
        pb=A[0, 2],
        vb=A[1, 2],
        old_p=half + steps * step * step,
    )
    if model.A[1, 0] == 0.0:
        return arrays
    left = A @ model.B[:, 0]
    return arrays._replace(
        old_p=left[0],
        old_v=left[1] - step,
        pp=A[0, 0] - 1.0,
        vp=A[1, 0],
        vv=A[1, 1] - 1.0,
        lean=find_lean_terms(model, half),
    )


#: Longest transient that is stored, in steps (2621 s at 100 Hz). The covariance of a bias without
#: noise falls as a power of time and never settles; after so many steps the last cycle is repeated.
LONGEST_TRANSIENT = 2**18


@dataclass(frozen=True, eq=False)
class Chain:
    """A scheme as arrays: [MHE ->] filter [-> smoother] [-> predictor].

    Two chains are equal only if they are the same object, so that they can be keys of caches.

    gains: the filter's gains and covariances. The covariances are NaN if the scheme states none.
    filter, predictor, mhe: the arrays that kernels take for filter and smoother, predictor, and
        MHE.
    axis: the filter's model and variances for one axis; None without covariances.
    input_model: the predictor's model; None without a predictor or without covariances.
    """

    gains: GainSchedule
    filter: FilterArrays
    predictor: PredictorArrays
    mhe: HorizonArrays
    axis: AxisFilter | None
    input_model: Discrete | None

    @cached_property
    def covariance(self) -> Array:
        """Covariance of position and velocity along an axis, (rows, 2, 2); NaN if not stated."""
        return self._covariance()

    @property
    def has_covariance(self) -> bool:
        """Whether the scheme states the covariance of its estimates; without, there is no NEES."""
        return not np.isnan(self.covariance[0, 0, 0])

    @cached_property
    def precision(self) -> Array:
        """The elements pp, pv, vv of the inverse of `covariance`, shape (rows, 3); zero for NaN."""
        return _precision(self.covariance)

    def for_runs(self) -> Chain:
        """Return this chain without the filter's covariances, which a run does not need.

        The result takes half the memory. `covariance` and `precision` are computed here. At first
        use, threads would wait for each other: before Python 3.12, all chains share one lock for
        cached properties.
        """
        none, covariance = np.empty((0, 4, 4)), self._covariance()
        result = replace(self, gains=replace(self.gains, predicted=none, filtered=none))
        vars(result).update(covariance=covariance, precision=_precision(covariance))
        return result

    def _covariance(self) -> Array:
        """Compute the covariance of the estimate's error along one axis, shape (rows, 2, 2).

        The prediction starts from the smoothed state of step s, `window` steps before the filter's
        newest sample. Input i of the prediction has the noise v_i. The smoother has seen the inputs
        inside its window. So the smoothed state's error and v_i have the covariance
        E[error_s v_i] = cov(error_s, error_i) h', where h is the measurement row of specific force.
        (v_i minus the optimal estimate of v_i is h error_i, and an optimal estimate is not
        correlated with its error.) The noise of inputs after the window is independent. The bias'
        walk during the prediction is added as if it were independent of the error; for the default
        sensors this term is 1e-3 of the rest.
        """
        axis, gains, window = self.axis, self.gains, self.filter.window
        if axis is None or self.input_model is None or self.predictor.steps == 0:
            return gains.filtered[:, :2, :2].copy()
        noise = prediction_noise(self.input_model, self.predictor.steps)
        pick = SIGMA_2_STATES
        # without a window there are no smoother gains
        C = self.filter.C if window > 0 else gains.filtered
        rows = FilterRows(gains.filtered, gains.predicted, C)
        result = np.empty((gains.rows, 2, 2))
        for first in range(0, gains.rows, _ROWS_AT_ONCE):  # the working copies stay small
            count = min(_ROWS_AT_ONCE, gains.rows - first)
            smoothed = np.broadcast_to(axis.initial_covariance, (count, 4, 4)).copy()
            coupling = np.zeros((count, 4, 3))
            covariances(rows, window, axis.force_row, noise.response, smoothed, coupling, first)
            covariance = noise.transition @ smoothed[:, pick[:, None], pick] @ noise.transition.T
            cross = noise.transition @ coupling[:, pick]
            covariance += cross + cross.transpose(0, 2, 1)
            covariance += noise.process + axis.force_variance * noise.response.T @ noise.response
            result[first : first + count] = covariance[:, :2, :2]
        return result


def _precision(covariance: Array) -> Array:
    """Invert covariances (rows, 2, 2); return pp, pv, vv (rows, 3), which are zero for NaN."""
    result = aligned(len(covariance), 3)
    if np.isnan(covariance[0, 0, 0]):
        return result
    for first in range(0, len(covariance), _ROWS_AT_ONCE):  # the working copies stay small
        part = slice(first, first + _ROWS_AT_ONCE)
        result[part] = np.linalg.inv(covariance[part])[:, [0, 0, 1], [0, 1, 1]]
    return result


#: Number of rows of a gain schedule whose covariances are computed at once.
_ROWS_AT_ONCE = 8192


@dataclass(frozen=True)
class Parts:
    """The parts of a linear scheme: [MHE ->] filter [-> smoother -> predictor].

    axis: the filter's model and variances for one axis.
    rule: how a step without a position fix is treated, one of `estimation.gains.RULES`.
    fix_rule: how much the positions count that the filter gets; no matter to `chain`.
    input_delay: number of steps by which the specific force is delayed (the paper's register 1).
    window: the smoother's lag N_s in steps; 0 for no smoother.
    predict: the predictor's model over one step, with the states position, velocity, bias; None if
        the filter's state is the estimate. It predicts over input_delay + window steps.
    horizon: the MHE whose positions replace the position fixes.
    """

    axis: AxisFilter
    rule: str
    fix_rule: Weighing = ALIKE
    input_delay: int = 0
    window: int = 0
    predict: Discrete | None = None
    horizon: Horizon | None = None

    @property
    def ahead(self) -> int:
        """Number of steps over which the predictor predicts."""
        return 0 if self.predict is None else self.input_delay + self.window


def chain(
    parts: Parts, sensors: Sensors, steps: int = LONGEST_TRANSIENT, *, maps: bool = True
) -> Chain:
    """Make a chain from its parts.

    steps: length of the longest record. Gains are stored for at most so many steps.
    maps: whether the MHE's maps are made. They may take seconds; a chain that lacks them cannot
        run, but its gains and covariances are the same.
    """
    axis, window, horizon = parts.axis, parts.window, parts.horizon
    M = sensors.fix_interval
    gains = schedule(
        axis.rates(parts.rule),
        axis.initial_covariance,
        interval=horizon.interval if horizon else M,
        steps=min(steps, LONGEST_TRANSIENT),
        start_interval=M,
        start_steps=horizon.first * M if horizon else 0,
    )
    if window > 0:
        C, D = smoother_gains(gains, axis.model.A, window)
    else:
        C, D = np.zeros((1, 4, 4)), np.zeros((1, 4, 2))
    return Chain(
        gains=gains,
        filter=FilterArrays(
            A=np.ascontiguousarray(axis.model.A),
            B=axis.model.B[:, 0].copy(),
            h=axis.force_row,
            K=gains.K,
            applied=gains.applied,
            C=C,
            D=D,
            cycle=gains.cycle,
            input_delay=parts.input_delay,
            window=window,
            fix_interval=M,
        ),
        predictor=predictor_arrays(parts.predict, parts.ahead, sensors.step),
        mhe=horizon.arrays(gains, sensors) if horizon and maps else NO_HORIZON,
        axis=axis,
        input_model=parts.predict,
    )


NO_HORIZON = HorizonArrays(
    active=False, maps=np.zeros((1, 3, 1)), horizon=1, interval=1, first=0, arrival=False,
    inputs=0, step=0.0, growth=np.zeros((1, 2, 3)), lean=NO_LEAN,
)  # fmt: skip


def lag_of(chain: Chain) -> int:
    """Return by how many steps the filter's states, smoothed or not, are behind the present."""
    return chain.filter.input_delay + chain.filter.window


def has_acceleration(chain: Chain) -> bool:
    """Return whether acceleration is a state that the chain's filter estimates."""
    return bool(np.any(chain.filter.h))


def bias_of(state: Array, sensors: Sensors) -> Array:
    """Compute the bias R b^b of the IMU in NED, m/s^2, shape (n, 2), from states (n, 4, 2).

    The fourth state is x4 = -R b^b + g, Eq. (6) of Ren et al. (2019).
    """
    return np.asarray(np.array(sensors.gravity) - state[:, 3])
