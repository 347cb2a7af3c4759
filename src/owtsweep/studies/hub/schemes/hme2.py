"""HME2, Algorithm 2: HME1 whose filter takes the moving horizon estimator's positions."""

from __future__ import annotations

from collections import deque
from functools import lru_cache
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import discretise
from owtsweep.estimation.mhe import CasadiWindow, square_root_information
from owtsweep.estimation.predictor import predict
from owtsweep.studies.hub.chain import LONGEST_TRANSIENT, Chain, chain, shared
from owtsweep.studies.hub.contract import Estimate, Sensors
from owtsweep.studies.hub.horizon import Horizon, horizon, transition_over
from owtsweep.studies.hub.models import axis_filter, input_model, sigma_2
from owtsweep.studies.hub.schemes.hme1 import DelayedChain

_I = np.eye(2)


class MovingHorizonEstimator:
    """Registers 2 and 3 and the optimisation (Algorithms 4 and 5, Eq. 11), two axes.

    Printed: both parts of register 2 are built from register 1; its own past is meant.
    """

    def __init__(self, mhe: Horizon, sensors: Sensors, gains: Chain, solver: str) -> None:
        self.mhe, self.sensors, self.gains, self.solver = mhe, sensors, gains, solver
        self.model = discretise(sigma_2(0.0, 0.0), sensors.step)
        self.fixes: deque[Array] = deque(maxlen=mhe.length + 1)
        self.effects: deque[Array] = deque(maxlen=mhe.length)  # of the inputs, per interval
        self.states: dict[int, Array] = {}  # register 3, by the number of the fix
        self.inputs: list[Array] = []  # since the last fix, as the MHE sees them
        self.recent: list[Array] = []  # since the last tick of T_m
        self.held: Array = np.zeros(2)
        self.fix_number = -1

    def take_fix(self, fix: Array) -> None:
        """Register 2, every T_g."""
        self.fix_number += 1
        if self.fix_number > 0:
            self.effects.append(self._effect())
        self.inputs = []
        self.fixes.append(fix)

    def take_input(self, step: int, force: Array) -> None:
        """Register 2: the input (NED) that is held over the step that now begins."""
        self.recent.append(force)
        if step % self.mhe.interval == 0:
            averaged = np.sum(self.recent, axis=0) / self.mhe.interval
            self.held = averaged if self.mhe.inputs == "averaged" else force
            self.recent = []
        self.inputs.append(force if self.mhe.inputs == "all" else self.held)

    def take_state(self, x: Array) -> None:
        """Register 3, at the fixes: x1, x2, x4 of the filter."""
        self.states[self.fix_number] = x[[0, 1, 2, 3, 6, 7]]
        self.states.pop(self.fix_number - self.mhe.length - 1, None)

    def position(self, since_fix: int) -> Array:
        """The position now (delayed time), `since_fix` steps after the newest fix."""
        n = len(self.effects)
        uses_filter = self.mhe.uses_filter(self.fix_number)
        fixed = self.mhe.is_fixed(self.fix_number)
        problem = _problem(
            n,
            last_node=since_fix > 0,
            arrival=self.mhe.arrival and not fixed,
            fixed_arrival=fixed,
            use_first_fix=not uses_filter,
            solver=self.solver,
        )
        M = self.sensors.fix_interval
        weights = self.mhe.weights
        effects = [*self.effects] + ([self._effect()] if since_fix else [])
        prior: Array = np.eye(6)
        x0: Array = np.zeros(6)
        covariance = self.mhe.arrival_covariance(self.fix_number, self.gains.gains, M)
        if covariance is not None:
            prior = np.kron(square_root_information(covariance), _I)
        if uses_filter:
            x0 = self.states[self.fix_number - self.mhe.length]
        deviation = np.sqrt(np.diagonal(weights.link_covariance))
        scale = np.kron([np.sqrt(weights.fix_variance), deviation[1], deviation[2]], [1.0, 1.0])
        nodes = problem.solve(
            scale,
            np.array(self.fixes).T,
            np.array(effects).reshape(-1, 6).T,
            np.kron(weights.transition, _I),
            np.kron(transition_over(since_fix * self.sensors.step), _I),
            np.kron(square_root_information(weights.link_covariance), _I),
            1.0 / np.sqrt(weights.fix_variance),
            x0,
            prior,
        )
        return nodes[:2, -1]

    def _effect(self) -> Array:
        """B u of the inputs since the last fix, (6,)."""
        inputs = np.array(self.inputs).reshape(-1, 2)
        axes = [predict(self.model, np.zeros(3), inputs[:, [i]]) for i in range(2)]
        return np.array(axes).T.ravel()


@lru_cache(maxsize=256)
def _problem(intervals: int, **kind: Any) -> CasadiWindow:
    """A window's problem on two axes; it holds no data, so all estimators share it."""
    return CasadiWindow(intervals, states=6, outputs=2, **kind)


class HME2Estimator:
    """Algorithm 2, one step at a time."""

    def __init__(self, sensors: Sensors, tuning: Any, gains: Chain) -> None:
        mhe = horizon(tuning.hme.mhe, sensors)
        self.sensors = sensors
        self.chain = DelayedChain(tuning.hme2, window_of(tuning), sensors, gains)
        self.mhe = MovingHorizonEstimator(mhe, sensors, gains, tuning.hme.mhe.solver)
        self.settings = mhe
        self.held_fix: Array = np.zeros(2)
        self.step = 0

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """One pass through Algorithm 2."""
        delayed = self.chain.push(specific_force)
        if position is not None:
            self.mhe.take_fix(np.array(position, dtype=float))
        since_fix = self.step % self.sensors.fix_interval
        fix = None
        if self.mhe.fix_number < self.settings.first:
            fix = position  # too few fixes for a window: they pass through
        elif self.step % self.settings.interval == 0:
            fix = self.mhe.position(since_fix)
        if fix is not None:
            self.held_fix = fix
        estimate, filtered = self.chain.step(delayed, fix, self.held_fix)
        if position is not None:
            self.mhe.take_state(filtered.x)
        self.mhe.take_input(self.step, self.sensors.rotation @ delayed)
        self.step += 1
        return estimate


def window_of(tuning: Any) -> int:
    """HME2's smoother window: its own, or the one that HME1 has."""
    own = tuning.hme.mhe.smoother_window
    return int(tuning.hme.smoother_window if own is None else own)


class HME2:
    """The hub motion estimator 2, tuned by `hme2` and `hme`."""

    name = "HME2"
    linear = True
    sections = ("hme2", "hme")

    def start(self, sensors: Sensors, tuning: Any) -> HME2Estimator:
        """A fresh estimator."""
        return HME2Estimator(sensors, tuning, self.kernel(sensors, tuning))

    @shared
    def kernel(self, sensors: Sensors, tuning: Any, steps: int = LONGEST_TRANSIENT) -> Chain:
        """The scheme for the batch engine, for records of that many steps."""
        return chain(
            axis_filter(tuning.hme2, sensors),
            sensors,
            rule=tuning.hme2.update_rule,
            input_delay=sensors.delay,
            window=window_of(tuning),
            predict=input_model(tuning.hme2, sensors),
            horizon=horizon(tuning.hme.mhe, sensors),
            steps=steps,
        )


SCHEME = HME2()
