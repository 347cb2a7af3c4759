"""Runs a scheme as on board: one compiled call per IMU sample, gains for the fixes that arrived.

The kernels work in coordinates about an origin. Here, at their boundary, the origin is subtracted
from the fixes and added to the estimates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array, make_rows
from owtsweep.estimation.discretisation import prediction_noise
from owtsweep.estimation.mhe import square_root_information
from owtsweep.estimation.weighing import ALIKE
from owtsweep.evaluation.trajectory import spread_to_both_axes
from owtsweep.studies.hub.chain import Parts, predictor_arrays
from owtsweep.studies.hub.contract import ZERO
from owtsweep.studies.hub.horizon import INPUTS, Horizon, growth_over, lean_terms
from owtsweep.studies.hub.kernels.layout import NO_LEAN, STATE
from owtsweep.studies.hub.kernels.online_layout import (
    COUNTERS,
    LINKS,
    ROW,
    STEP,
    FilterSettings,
    HorizonSettings,
    OnlineEstimates,
    OnlineRegisters,
)
from owtsweep.studies.hub.online.coordinates import (
    FARTHEST,
    LocatedEstimator,
    check_grid,
    check_origin,
    check_samples,
    make_estimates,
    start_at_first_fix,
)
from owtsweep.studies.hub.sensors import Sensors


def filter_settings(parts: Parts, sensors: Sensors) -> FilterSettings:
    """Make the settings of filter, smoother and predictor for the online kernels."""
    axis = parts.axis
    rates = axis.rates(parts.rule)
    ahead: Array = np.eye(3)
    response: Array = np.zeros((1, 3))
    added: Array = np.zeros((3, 3))
    if parts.predict is not None and parts.ahead > 0:
        noise = prediction_noise(parts.predict, parts.ahead)
        ahead, response = noise.transition, noise.response
        added = noise.process + axis.force_variance * response.T @ response
    return FilterSettings(
        A=rates.A,
        B=axis.model.B[:, 0].copy(),
        h=axis.force_row,
        rates=rates,
        P0=axis.initial_covariance,
        fix_interval=sensors.fix_interval,
        delay=parts.input_delay,
        window=parts.window,
        predicts=parts.predict is not None,
        predictor=predictor_arrays(parts.predict, parts.ahead, sensors.step),
        ahead=np.ascontiguousarray(ahead),
        response=np.ascontiguousarray(response),
        added=np.ascontiguousarray(added),
        rotation=sensors.rotation,
        gravity=np.array(sensors.gravity),
        fix_rule=parts.fix_rule,
    )


def horizon_settings(mhe: Horizon | None, sensors: Sensors) -> HorizonSettings:
    """Make the settings of the MHE for the online kernels; not `active` without an MHE."""
    eye = np.eye(3)
    if mhe is None:
        free = np.full(3, np.inf)
        none = np.zeros((1, 2, 3))
        return HorizonSettings(
            False, 1, 1, 0, 0, sensors.step, eye, eye, 1.0, eye, False, free, none, NO_LEAN,
            ALIKE,
        )  # fmt: skip
    return HorizonSettings(
        active=True,
        interval=mhe.interval,
        length=mhe.length,
        arrival=(2 if mhe.fixed else 1) if mhe.arrival else 0,
        inputs=INPUTS.index(mhe.inputs),
        step=sensors.step,
        transition=np.ascontiguousarray(mhe.weights.transition),
        link=np.ascontiguousarray(square_root_information(mhe.weights.link_covariance)),
        inverse_sigma=float(1.0 / np.sqrt(mhe.weights.fix_variance)),
        prior=np.ascontiguousarray(square_root_information(mhe.initial_covariance)),
        constrained=bool(np.any(np.isfinite(mhe.bounds))),
        bounds=mhe.bounds,
        growth=growth_over(mhe.lean, sensors, sensors.fix_interval),
        lean=lean_terms(mhe.lean, sensors.step),
        fix_rule=mhe.fix_rule,
    )


def new_registers(f: FilterSettings, h: HorizonSettings) -> OnlineRegisters:
    """Make the registers of a new online estimator: zeros, except the filter's covariance, f.P0.

    The algorithms of Ren et al. (2019) start from zero. The counter ROW starts behind the rows that
    stand for the time before the first step.
    """
    keep = f.delay + f.window + 2
    rows = 3 * keep + 64
    counter = np.zeros(COUNTERS, dtype=np.int64)
    counter[ROW] = keep  # rows before the first step are zero
    n = h.length
    return OnlineRegisters(
        counter=counter,
        P=f.P0.copy(),
        work=np.zeros((3, 4, 4)),
        predicted=np.zeros((1, 2)),
        given=np.zeros((1, 2)),
        force=np.zeros((rows, 2)),
        steps=make_rows(rows, 2, "r", "s", *STATE),
        K=np.zeros((rows, 4, 2)),
        C=np.zeros((rows, 4, 4)),
        Pm=np.zeros((rows, 4, 4)),
        Pf=np.zeros((rows, 4, 4)),
        back=make_rows(1, 2, "r", "s", *STATE),
        inputs=make_rows(1, 2, "p", "v"),
        estimate=make_rows(1, 2, "r", "s", *STATE),
        smoothed=np.zeros((f.window + 1, 4, 4)),
        coupling=np.zeros((f.window + 1, 4, 3)),
        no_coupling=np.zeros((4, 3)),
        zero=np.zeros((3, 2)),
        z=np.zeros((n + 1, 2)),
        have=np.zeros(n + 1, dtype=np.bool_),
        weight=np.ones(n + 1),
        effects=np.zeros((n, 3, 2)),
        states=np.zeros((n + 1, 3, 2)),
        covariances=np.zeros((n + 1, 3, 3)),
        now=make_rows(1, 2, "gathered", "sample", "p", "v"),
        prior=np.zeros((3, 3)),
        node=np.zeros((3, 2)),
        nodes=np.zeros((n + 2, 3, 2)),
        blocks=np.zeros((n, 3, 8)),
    )


TOO_FAR = (
    "position: the first fix lies {distance:.6g} m from the origin ({x:g}, {y:g}), but the schemes "
    "start within some metres of it; state an origin near the hub, or none: then it is the first "
    "fix"
)
_EYE = np.eye(2)


class OnlineEstimator(LocatedEstimator):
    """A running scheme: `update` takes one IMU sample, `run` takes many samples.

    Any position fix may be missing. EKF, MKF and HME1 take fixes at any step, HME2 only at
    multiples of the fix interval. Fixes and estimates are in the caller's coordinates, e.g. of a
    map. Where the origin is the first fix, the estimator starts with this fix: until then,
    estimates are NaN and their variances infinite, and HME2 counts its multiples from there.

    parts: of the scheme.
    solver: name of the solver for the MHE's windows that break a constraint.
    origin: the point about which the scheme starts from zero, shape (2,), m in NED; None for the
        first fix, whose noise is then the uncertainty of the first position.
    Raises InputError if the origin is not two finite numbers.
    """

    def __init__(
        self, parts: Parts, sensors: Sensors, solver: str, origin: ArrayLike | None = ZERO
    ) -> None:
        point = check_origin(origin)
        super().__init__(sensors, point)
        if point is None:
            parts = start_at_first_fix(parts)
        self._mhe, self._solver = parts.horizon, solver
        self._filter = filter_settings(parts, sensors)
        self._horizon = horizon_settings(parts.horizon, sensors)
        self._registers = new_registers(self._filter, self._horizon)
        #: How often the MHE's window was solved with constraints, because they were violated.
        self.solved = 0
        self._lost = ""
        self._located = False  # no fix has come yet
        self._skipped = 0  # samples before the first fix, where that is the origin

    def run(self, specific_force: Array, positions: Array) -> OnlineEstimates:
        """Take many IMU samples at once; the result is as if `update` took sample after sample.

        specific_force, positions: m/s^2 in the IMU's frame, and m in NED, shape (steps, 2) each.
            Both components of a position are NaN at steps without a fix.
        Returns: arrays with one row per step.
        Raises ValueError if the shapes are wrong, a number is not finite, a fix comes at a step at
        which HME2 cannot take fixes, or the first fix lies more than 100 km from a stated origin.
        The estimator is left unchanged.
        Raises ArithmeticError if the solver cannot meet the constraints of the MHE. Some samples
        are then processed already, one of them only partly, so every later call raises this error
        too: start a new estimator.
        """
        from owtsweep.studies.hub.kernels.online import advance

        specific_force = np.ascontiguousarray(specific_force, dtype=float)
        positions = np.ascontiguousarray(positions, dtype=float)
        unknown = self._check(specific_force, positions)
        out = make_estimates(len(specific_force), unknown)
        self._skipped += unknown
        if self._origin is None:  # still no fix
            return out
        samples = specific_force[unknown:], positions[unknown:] - self._origin
        part = OnlineEstimates(*(series[unknown:] for series in out)) if unknown else out
        done, resume, steps = 0, False, len(samples[0])
        while done < steps:
            done = advance(
                done, resume, samples, self._filter, self._horizon, self._registers, part
            )
            if done == steps:
                break
            try:
                self._solve_with_constraints()
            except ArithmeticError as error:
                step = self._skipped + int(self._registers.counter[STEP])
                self._lost = f"{error}, at step {step}; start a new estimator"
                raise ArithmeticError(self._lost) from error
            resume = True
        part.state[:, :2] += self._origin
        return out

    def _run(self, specific_force: Array, positions: Array) -> tuple[Array, Array, Array, Array]:
        out = self.run(specific_force, positions)
        variance = out.innovation_variance[:, None, None] * _EYE
        return out.state, spread_to_both_axes(out.covariance), out.innovation, variance

    def _check(self, force: Array, positions: Array) -> int:
        """Check samples; return the number of steps before a first fix that is the origin."""
        if self._lost:
            raise ArithmeticError(self._lost)
        first = self._skipped + int(self._registers.counter[STEP])
        at = check_samples(force, positions, first)
        if len(at) == 0:
            return 0 if self._origin is not None else len(force)
        unknown = int(at[0]) if self._origin is None else 0
        if self._horizon.active:
            begin = self._skipped + unknown
            check_grid("HME2", first + at, self._sensors.fix_interval, begin)
        if not self._located:
            self._locate(positions[at[0]])
        return unknown

    def _locate(self, fix: Array) -> None:
        """Take the first fix (2,): it becomes the origin, or must lie near the stated one."""
        if self._origin is None:
            self._origin = fix.copy()
        distance = float(np.linalg.norm(fix - self._origin))
        if distance > FARTHEST:
            x, y = self._origin
            raise ValueError(TOO_FAR.format(distance=distance, x=x, y=y))
        self._located = True

    def _solve_with_constraints(self) -> None:
        """Solve the MHE's window with its constraints; put the result into the registers."""
        from owtsweep.studies.hub import window

        if self._mhe is None:
            raise TypeError("there is no window without an MHE")
        m, n = self._registers, int(self._registers.counter[LINKS])
        number, since = divmod(int(m.counter[STEP]), self._sensors.fix_interval)
        effects = m.effects[:n].reshape(n, 6)
        if since:
            effects = np.vstack([effects, [*m.now["p"][0], *m.now["v"][0], 0.0, 0.0]])
        past = (m.states[0].ravel(), m.covariances[0]) if self._mhe.uses_filter(number) else None
        nodes = window.solve(
            self._mhe,
            self._sensors,
            solver=self._solver,
            since_fix=since,
            fixes=m.z[: n + 1],
            have=m.have[: n + 1],
            effects=effects,
            past=past,
        )
        last = nodes[:, -1].reshape(3, 2)
        if not since:
            m.node[:] = last
        m.given[0] = last[0]
        self.solved += 1
