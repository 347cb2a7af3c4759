"""SWITCH: two schemes side by side, of which a supervisor hands out one.

The conclusion of Ren et al. (2019) proposes to switch between HME1 and HME2 by the amplitude and
the period of the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.evaluation.loop import RecordEstimator, run_steps
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import ZERO, Estimator, Known, Scheme, resolve
from owtsweep.studies.hub.switching.boundary import check_switch, compute_boundary, read_boundary
from owtsweep.studies.hub.switching.supervisor import SeaWatch, Supervisor, error_variances


class SwitchingEstimator(RecordEstimator):
    """Two estimators on the same measurements, of which a supervisor hands out one.

    The supervisor watches the estimates of the scheme above the boundary, since that scheme follows
    large motion. While it changes over, position and velocity are weighted means of both schemes.
    The stated covariance is then the weighted mean of both covariances: by convexity of the square,
    no weighted mean of two estimates has a larger one, however their errors are correlated. The
    innovation is that of the scheme with the larger weight.
    """

    def __init__(self, below: Any, above: Any, supervisor: Supervisor) -> None:
        self._below, self._above, self.supervisor = below, above, supervisor

    @property
    def step(self) -> float:
        return float(self._below.step)

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        below = self._below.update(specific_force, position)
        above = self._above.update(specific_force, position)
        (x, y), (vx, vy) = above.position.tolist(), above.velocity.tolist()
        weight = self.supervisor.step(x, y, vx, vy, error_variances(above.covariance))
        if weight in (0.0, 1.0):
            chosen: Estimate = above if weight else below
            return chosen
        covariance = None
        if below.covariance is not None and above.covariance is not None:
            covariance = _blend(weight, below.covariance, above.covariance)
        return Estimate(
            _blend(weight, below.position, above.position),
            _blend(weight, below.velocity, above.velocity),
            covariance,
            above.innovation if weight >= 0.5 else below.innovation,
        )

    def run_record(self, specific_force: Array, positions: Array) -> Trajectory:
        below, above = (
            run_steps(each, specific_force, positions) for each in (self._below, self._above)
        )
        noise = np.zeros((len(above.state), 2))
        if above.covariance is not None:
            variances = np.nan_to_num(np.einsum("kii->ki", above.covariance))
            noise = variances.reshape(-1, 2, 2).sum(axis=2)
        decide = self.supervisor.step
        weight = np.array([
            decide(x, y, vx, vy, (of_position, of_velocity))
            for (x, y, vx, vy), (of_position, of_velocity) in zip(
                above.state.tolist(), noise.tolist(), strict=True
            )
        ])  # fmt: skip
        return _join(weight, below, above)


def _blend(weight: float | Array, below: Array, above: Array) -> Array:
    """Return the mean of two arrays; `weight` is that of the array `above`."""
    return np.asarray(below + weight * (above - below))


def _join(weight: Array, below: Trajectory, above: Trajectory) -> Trajectory:
    """Return the blend of two trajectories; `weight` (steps,) is that of the trajectory `above`."""
    state = _blend(weight[:, None], below.state, above.state)
    covariance = None
    if below.covariance is not None and above.covariance is not None:
        covariance = _blend(weight[:, None, None], below.covariance, above.covariance)
        only = (weight == 0.0) | (weight == 1.0)  # the other scheme may state none at this step
        chosen = (weight[only] == 1.0)[:, None, None]
        covariance[only] = np.where(chosen, above.covariance[only], below.covariance[only])
    mostly = weight >= 0.5
    return Trajectory(
        state,
        covariance,
        _pick(mostly, below.innovation, above.innovation),
        _pick(mostly, below.innovation_covariance, above.innovation_covariance),
    )


def _pick(mostly: NDArray[np.bool_], below: Array | None, above: Array | None) -> Array | None:
    """Return the rows of `above` where `mostly` is true, else those of `below`.

    A scheme without these arrays has rows of NaN; the result is None if neither has them.
    """
    there = above if below is None else below
    if there is None:
        return None
    shape = (-1, *(1,) * (there.ndim - 1))
    little, much = (np.nan if each is None else each for each in (below, above))
    return np.where(mostly.reshape(shape), much, little)


class SupervisorySwitching(Scheme):
    """The scheme SWITCH. Its tuning is the section `switch` and the sections of its two schemes."""

    name = "SWITCH"
    on_board = True
    sections: tuple[str, ...] = ("switch", "ekf", "mkf", "hme1", "hme2", "hme")

    def under(self, config: HubConfig) -> SupervisorySwitching:
        """Return the scheme with the sections of those two schemes that the tuning names."""
        below, above = _choose_schemes(config)
        chosen = SupervisorySwitching()
        chosen.sections = ("switch", *dict.fromkeys((*below.sections, *above.sections)))
        return chosen

    def start(self, known: Known) -> SwitchingEstimator:
        return _start(known, lambda scheme: scheme.start(known))

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> SwitchingEstimator:
        """Return a new estimator of two schemes that are compiled where they can be."""
        return _start(known, lambda scheme: scheme.stream(known, origin))

    def check(self, config: HubConfig) -> None:
        check_switch(self.name, config.switch)


def _choose_schemes(config: HubConfig) -> tuple[Scheme, Scheme]:
    below, above = resolve(config.switch.below), resolve(config.switch.above)
    return below.under(config), above.under(config)


def _start(known: Known, started: Callable[[Scheme], Estimator]) -> SwitchingEstimator:
    """Return a new estimator; `started` makes that of each of the two schemes."""
    sensors, settings = known.sensors, known.tuning.switch
    below, above = _choose_schemes(known.tuning)
    if settings.boundary is None:
        boundary = compute_boundary(known.tuning, settings.below, settings.above, settings.crest)
    else:
        boundary = read_boundary(settings.boundary)
    watch = SeaWatch(sensors.step, settings.memory, settings.crest)
    supervisor = Supervisor(watch, boundary, settings, sensors.step, sensors.fix_interval)
    return SwitchingEstimator(started(below), started(above), supervisor)


SCHEME = SupervisorySwitching()
