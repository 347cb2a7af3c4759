"""HME2: like HME1, but the filter gets its positions from a moving horizon estimator.

Source: Algorithm 2 of Ren et al. (2019).
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import discretise, predict
from owtsweep.evaluation.estimate import Estimate
from owtsweep.gravity import GRAVITY
from owtsweep.studies.hub import window
from owtsweep.studies.hub.checks import check_mhe
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, Scheme, run_stepwise
from owtsweep.studies.hub.horizon import Horizon, horizon
from owtsweep.studies.hub.models import SIGMA_2_STATES, make_fix_rule, sigma_2
from owtsweep.studies.hub.online.coordinates import check_grid
from owtsweep.studies.hub.schemes.hme1 import HME1, HME1Estimator
from owtsweep.studies.hub.schemes.multirate import FilterStep
from owtsweep.studies.hub.sensors import Sensors


class HME2Estimator(HME1Estimator):
    """HME2 as an estimator that runs step by step: Algorithm 2 of Ren et al. (2019).

    It has the MHE on two axes, with its registers 2 and 3. Register 2 stores position fixes and
    inputs; register 3 stores states of the filter. There is a node at each step at which a fix is
    due. If the fix is missing, the node has no measurement. Source: Algorithms 4 and 5 and Eq. (11)
    of Ren et al. (2019). The paper prints that both parts of register 2 are built from register 1.
    This class builds both from the past of register 2, which must be what the paper means.
    """

    def __init__(self, known: Known, scheme: HME2) -> None:
        super().__init__(known, scheme)
        mhe = scheme.make_horizon(known.tuning, known.sensors)
        self.mhe, self.solver = mhe, known.tuning.hme.mhe.solver
        self.model = discretise(sigma_2(0.0, 0.0, mhe.lean), known.sensors.step)
        self.fixes: deque[Array | None] = deque(maxlen=mhe.length + 1)
        self.effects: deque[Array] = deque(maxlen=mhe.length)  # B u, one per GNSS interval
        # register 3, by the number of the node; windows start from these states
        self.states: dict[int, FilterStep] = {}
        self.inputs: list[Array] = []  # since the last node, held or averaged as the MHE uses them
        self.recent: list[Array] = []  # samples since the last multiple of the MHE's interval T_m
        self.held: Array = np.zeros(2)
        self.fix_number = -1

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the estimate of the present.

        Raises ValueError if a fix comes at a step at which no fix is due. The MHE could not use it.
        """
        interval = self.sensors.fix_interval
        since_fix = self.count % interval
        if position is not None:
            check_grid("HME2", np.array([self.count]), interval)
        delayed = self.push(specific_force)
        if since_fix == 0:
            if position is None:
                self.on_schedule = False
            self.take_fix(None if position is None else np.array(position, dtype=float))
        fix = None
        if not self.determined():
            fix = position  # too few fixes for a window: the filter gets the fix itself
        elif self.count % self.mhe.interval == 0:
            fix = self.position(since_fix)
        self.take_input(self.count, self.sensors.rotation @ delayed)
        estimate, filtered = self.advance(delayed, fix)
        if since_fix == 0:
            self.states[self.fix_number] = filtered
            self.states.pop(self.fix_number - self.mhe.length - 1, None)
        return estimate

    def take_fix(self, fix: Array | None) -> None:
        """Begin the next node, when a fix is due; store the fix in NED, m, (2,), in register 2."""
        self.fix_number += 1
        if self.fix_number > 0:
            self.effects.append(self._effect())
        self.inputs = []
        self.fixes.append(fix)

    def determined(self) -> bool:
        """Return whether the window has enough position fixes to determine the window's states.

        One fix is enough if there is an arrival term (a prior of the oldest state); otherwise three
        are. A prior from the filter already includes the oldest fix, which then does not count.
        """
        used = list(self.fixes)[1 if self.mhe.uses_filter(self.fix_number) else 0 :]
        return sum(fix is not None for fix in used) >= (1 if self.mhe.arrival else 3)

    def take_input(self, step: int, force: Array) -> None:
        """Store the specific force of a step, in NED, m/s^2, shape (2,), in register 2."""
        self.recent.append(force)
        if step % self.mhe.interval == 0:
            averaged = np.sum(self.recent, axis=0) / self.mhe.interval
            self.held = averaged if self.mhe.inputs == "averaged" else force
            self.recent = []
        self.inputs.append(force if self.mhe.inputs == "all" else self.held)

    def position(self, since_fix: int) -> Array:
        """Solve the window; return the position `since_fix` IMU steps after the newest node.

        It is in NED, in m, shape (2,), at the delayed time at which the filter runs.
        """
        effects = [*self.effects] + ([self._effect()] if since_fix else [])
        past = None
        if self.mhe.uses_filter(self.fix_number):
            oldest = self.fix_number - self.mhe.length
            state, gains = self.states[oldest], self.gains.gains
            row = gains.row(oldest * self.sensors.fix_interval)
            P = gains.filtered[row] if self.on_schedule else state.P[::2, ::2]
            past = state.x[[0, 1, 2, 3, 6, 7]], P[np.ix_(SIGMA_2_STATES, SIGMA_2_STATES)]
        nodes = window.solve(
            self.mhe,
            self.sensors,
            solver=self.solver,
            since_fix=since_fix,
            fixes=np.array([np.zeros(2) if fix is None else fix for fix in self.fixes]),
            have=np.array([fix is not None for fix in self.fixes]),
            effects=np.array(effects),
            past=past,
        )
        return np.asarray(nodes[:2, -1])

    def _effect(self) -> Array:
        """Compute how much the inputs since the newest node have changed the state, shape (6,)."""
        inputs = np.array(self.inputs).reshape(-1, 2)
        axes = [predict(self.model, np.zeros(3), inputs[:, [i]]) for i in range(2)]
        return np.array(axes).T.ravel()


class HME2(HME1):
    """The scheme HME2 (hub motion estimator 2 of Ren et al. 2019)."""

    name = "HME2"
    sections = ("hme2", "hme")

    def start(self, known: Known) -> HME2Estimator:
        return HME2Estimator(known, self)

    def choose_window(self, tuning: HubConfig) -> int:
        """Return the smoother's window, in IMU steps: HME2's own, or else that of HME1."""
        window = tuning.hme.mhe.smoother_window
        return super().choose_window(tuning) if window is None else window

    def make_horizon(self, tuning: HubConfig, sensors: Sensors) -> Horizon:
        mhe = horizon(tuning.hme.mhe, sensors, GRAVITY * tuning.hme2.tilt)
        return replace(mhe, fix_rule=make_fix_rule(tuning.hme2))

    def under(self, config: HubConfig) -> Scheme:
        """Return `self`, to be run step by step with constraints, or if fixes lose weight."""
        if np.any(np.isfinite(config.hme.mhe.bounds)):
            return run_stepwise(self, "its constraints leave")
        return super().under(config)

    def check(self, config: HubConfig) -> None:
        super().check(config)
        check_mhe(config)


SCHEME = HME2()
