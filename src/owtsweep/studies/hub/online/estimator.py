"""Runs a scheme as on board: one compiled call per IMU sample, gains for the fixes that arrived."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.evaluation.trajectory import Trajectory, spread_to_both_axes
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.kernels.online_layout import (
    LINKS,
    STEP,
    FilterSettings,
    HorizonSettings,
    OnlineEstimates,
    OnlineRegisters,
)
from owtsweep.studies.hub.models import axis_filter, input_model
from owtsweep.studies.hub.online.registers import (
    filter_settings,
    horizon_settings,
    new_registers,
)

if TYPE_CHECKING:
    from owtsweep.studies.hub.horizon import Horizon
    from owtsweep.studies.hub.sections import FilterTuning

OFF_GRID = (
    "position: a fix came at step {step}, but HME2 takes fixes only at multiples of {interval} "
    "IMU steps; give the fix at the next multiple, or leave the fix out"
)
_EYE = np.eye(2)


class OnlineEstimator:
    """A running scheme: `update` takes one IMU sample, `run` takes many samples.

    Any position fix may be missing. EKF, MKF and HME1 take fixes at any step, HME2 only at
    multiples of the fix interval. A fix reports a past position, as old as the delay of the GNSS.

    Parameters
    ----------
    sensors
        The properties of the IMU and the GNSS.
    settings, horizon
        Settings for the kernels: of filter, smoother and predictor, and of the moving horizon
        estimator (MHE).
    mhe
        The moving horizon estimator; None for a scheme without one.
    solver
        Name of the solver for the MHE's windows that break a constraint.
    """

    def __init__(
        self,
        sensors: Sensors,
        settings: FilterSettings,
        horizon: HorizonSettings,
        mhe: Horizon | None,
        solver: str,
    ) -> None:
        self._sensors, self._mhe, self._solver = sensors, mhe, solver
        self._filter, self._horizon = settings, horizon
        self._registers: OnlineRegisters = new_registers(settings, horizon)
        self._force, self._fix = np.empty((1, 2)), np.empty((1, 2))
        #: How often the MHE's window was solved with constraints, because they were violated.
        self.solved = 0
        self._lost = ""

    @property
    def step(self) -> float:
        """The IMU's sampling interval, s."""
        return self._sensors.step

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample and perhaps a position fix; return the estimate of the present state.

        Parameters
        ----------
        specific_force
            Specific force in the IMU's frame, m/s^2, shape (2,).
        position
            The fix in NED, m, shape (2,): a past position, as old as the delay of the GNSS. None
            (or two NaN) if there is no fix.

        Returns
        -------
        Estimate
            Position (m) and velocity (m/s) in NED, covariance (4, 4) of x, y, v_x, v_y, and the
            innovation of the position; None in place of an innovation if the filter took no
            position at this step.

        Raises
        ------
        ValueError
            If a sample is not two finite numbers, or a fix comes at a step at which HME2 cannot
            take fixes. The estimator is left unchanged.
        ArithmeticError
            If the solver cannot meet the constraints of the moving horizon estimator. The sample is
            then only partly processed, so every later call raises this error too: start a new
            estimator.
        """
        _check_pair("specific_force", specific_force)  # NumPy would use one number for both
        if position is not None:
            _check_pair("position", position)
        self._force[0] = specific_force
        self._fix[0] = np.nan if position is None else position
        out = self.run(self._force, self._fix)
        innovation = None
        if out.innovation_variance[0] == out.innovation_variance[0]:  # not NaN
            innovation = Innovation(out.innovation[0], out.innovation_variance[0] * _EYE)
        P = out.covariance[0]
        covariance = np.zeros((4, 4))
        covariance[::2, ::2] = P
        covariance[1::2, 1::2] = P
        return Estimate(out.state[0, :2], out.state[0, 2:], covariance, innovation)

    def run(self, specific_force: Array, positions: Array) -> OnlineEstimates:
        """Take many IMU samples at once; the result is as if `update` took sample after sample.

        Parameters
        ----------
        specific_force, positions
            Specific force (m/s^2, IMU's frame) and position fixes (m, NED), shape (steps, 2) each.
            Both components of a position are NaN at steps without a fix.

        Returns
        -------
        OnlineEstimates
            Arrays with one row per step.

        Raises
        ------
        ValueError
            If the shapes are wrong, a number is infinite, a specific force is NaN, only one
            component of a fix is NaN, or a fix comes at a step at which HME2 cannot take fixes. The
            estimator is left unchanged.
        ArithmeticError
            If the solver cannot meet the constraints of the moving horizon estimator. Some samples
            are then processed already, so every later call raises this error too: start a new
            estimator.
        """
        from owtsweep.studies.hub.kernels.online import advance

        specific_force = np.ascontiguousarray(specific_force, dtype=float)
        positions = np.ascontiguousarray(positions, dtype=float)
        self._check(specific_force, positions)
        steps, samples = len(specific_force), (specific_force, positions)
        out = OnlineEstimates(
            np.empty((steps, 4)), np.empty((steps, 2, 2)), np.empty((steps, 2)), np.empty(steps)
        )
        done, resume = 0, False
        while True:
            done = advance(done, resume, samples, self._filter, self._horizon, self._registers, out)
            if done == steps:
                return out
            try:
                self._solve_with_constraints()
            except ArithmeticError as error:
                step = int(self._registers.counter[STEP])
                self._lost = f"{error}, at step {step}; start a new estimator"
                raise ArithmeticError(self._lost) from error
            resume = True

    def run_record(self, specific_force: Array, positions: Array) -> Trajectory:
        """Take many IMU samples at once, as `run` does; return the estimates as a `Trajectory`.

        `Trajectory` is what the functions of `owtsweep.evaluation` take. `specific_force` (m/s^2)
        and `positions` (m) have the shape (steps, 2) each. The errors are those of `run`.
        """
        out = self.run(specific_force, positions)
        return Trajectory(
            out.state,
            spread_to_both_axes(out.covariance),
            out.innovation,
            out.innovation_variance[:, None, None] * _EYE,
        )

    def _check(self, force: Array, positions: Array) -> None:
        if self._lost:
            raise ArithmeticError(self._lost)
        if force.ndim != 2 or force.shape[1] != 2 or force.shape != positions.shape:
            raise ValueError(
                f"specific_force, positions: their shapes are {force.shape} and "
                f"{positions.shape}; give both the shape (steps, 2)"
            )
        first = int(self._registers.counter[STEP])
        if not np.isfinite(force).all():
            step = first + int(np.argmax(~np.isfinite(force).all(axis=1)))
            raise ValueError(
                f"specific_force: it is not finite at step {step}; give two finite numbers"
            )
        there = positions == positions  # not NaN
        if not there.any():
            return
        if not np.array_equal(there[:, 0], there[:, 1]) or np.isinf(positions).any():
            raise ValueError(
                "position: a fix has a component that is missing or infinite; give both components "
                "as finite numbers, or leave the fix out"
            )
        if self._horizon.active:
            at = first + np.flatnonzero(there[:, 0])
            off = at[at % self._sensors.fix_interval != 0]
            if len(off):
                raise ValueError(OFF_GRID.format(step=off[0], interval=self._sensors.fix_interval))

    def _solve_with_constraints(self) -> None:
        """Solve the MHE's present window with its constraints; put the result into the registers.

        The MHE is the moving horizon estimator.

        Raises
        ------
        ArithmeticError
            If the solver cannot meet the constraints.
        """
        from owtsweep.studies.hub import window

        if self._mhe is None:
            raise TypeError("there is no window without an MHE")
        m, n = self._registers, int(self._registers.counter[LINKS])
        number, since = divmod(int(m.counter[STEP]), self._sensors.fix_interval)
        effects = m.effects[:n].reshape(n, 6)
        if since:
            effects = np.vstack([effects, [*m.running[0], *m.running[1], 0.0, 0.0]])
        filled = self._mhe.uses_filter(number)
        covariance = None
        if self._mhe.arrival:
            covariance = m.covariances[0] if filled else self._mhe.initial_covariance
        nodes = window.solve(
            self._mhe,
            self._sensors,
            solver=self._solver,
            since_fix=since,
            fixes=m.z[: n + 1],
            have=m.have[: n + 1],
            effects=effects,
            filled=filled,
            x0=m.states[0].ravel() if filled and self._mhe.arrival else np.zeros(6),
            covariance=covariance,
        )
        last = nodes[:, -1].reshape(3, 2)
        if not since:
            m.node[:] = last
        m.given[:] = last[0]
        self.solved += 1


def online_chain(
    tuning: FilterTuning,
    sensors: Sensors,
    *,
    window: int = 0,
    delay: int | None = None,
    mhe: Horizon | None = None,
    solver: str = "qrqp",
) -> OnlineEstimator:
    """Make a new online estimator from settings: [MHE ->] filter [-> smoother -> predictor].

    Parts in brackets may be absent.

    Parameters
    ----------
    tuning
        The filter's tuning.
    window
        Length N_s of the smoother's window, in steps.
    delay
        Number of steps by which the specific force is delayed in register 1 of Ren et al. (2019).
        The predictor predicts over these steps and the smoother's window. None means that there is
        no predictor: the filter takes the specific force without delay, and the filter's state is
        the estimate.
    mhe
        The moving horizon estimator; None for a scheme without one.
    solver
        Name of the solver for the MHE's windows that break a constraint.
    """
    axis = axis_filter(tuning, sensors)
    predict = None if delay is None else input_model(tuning, sensors)
    settings = filter_settings(axis, sensors, tuning.update_rule, delay or 0, window, predict)
    return OnlineEstimator(sensors, settings, horizon_settings(mhe, sensors), mhe, solver)


def _check_pair(name: str, value: Array) -> None:
    if np.shape(value) != (2,):
        raise ValueError(f"{name}: {value!r} is not two numbers; give x and y")
