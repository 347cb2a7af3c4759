"""One scheme over one replicate of a record: estimates, their deviations, innovations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Estimate, Estimator, Scheme, Sensors
from owtsweep.studies.hub.sensors import Measurements

if TYPE_CHECKING:
    from owtsweep.studies.hub.online.estimator import OnlineEstimator


@dataclass(frozen=True)
class Estimated:
    """A scheme's estimates in NED.

    Attributes
    ----------
    state
        (steps, 4): x, y (m), v_x, v_y (m/s).
    covariance
        (steps, 2, 2, 2): of (p, v) for each axis (second index), or None.
    innovation, innovation_variance
        (steps, 2): of x and y (m), their variances (m^2); NaN at steps without; or None.
    """

    state: Array
    covariance: Array | None
    innovation: Array | None
    innovation_variance: Array | None

    @property
    def deviation(self) -> Array:
        """(steps, 4): standard deviations of x, y, v_x, v_y; NaN without a covariance."""
        return self.deviation_of(slice(None))

    def deviation_of(self, part: slice) -> Array:
        """The same of some steps."""
        if self.covariance is None:
            return np.full(self.state[part].shape, np.nan)
        P = self.covariance[part]
        return np.asarray(np.sqrt(np.concatenate([P[..., 0, 0], P[..., 1, 1]], axis=1)))


def estimate(
    config: HubConfig, scheme: Scheme, sensors: Sensors, measured: Measurements
) -> Estimated:
    """Run a scheme over a record.

    With every fix there the batch engine runs it; where fixes are missing its gains depend on
    which, and the online form computes them as it goes. The reference engine, and a user's scheme
    without either, runs one `update` per step.

    Raises
    ------
    ValueError
        If an estimate has the wrong shape or is not finite, naming the step.
    """
    if config.engine == "batch":
        complete = bool(np.all(np.isfinite(measured.fixes)))
        if complete and hasattr(scheme, "kernel"):
            chain = scheme.kernel(sensors, config, len(measured.specific_force))
            return _by_kernel(chain, sensors, measured)
        if hasattr(scheme, "stream"):
            return _online(scheme.stream(sensors, config), sensors, measured)
    return _step_by_step(scheme.start(sensors, config), sensors, measured)


def _by_kernel(chain: Chain, sensors: Sensors, measured: Measurements) -> Estimated:
    force = np.ascontiguousarray(measured.specific_force @ sensors.rotation.T)
    fixes = np.ascontiguousarray(measured.fixes)
    position, velocity, innovation = batch.trajectories(chain, sensors, force, fixes)
    row = chain.gains.row(np.arange(len(force)))
    fresh = chain.gains.fresh[row]
    innovation[~fresh] = np.nan
    variance = np.where(fresh, chain.gains.innovation_variance[row], np.nan)
    return Estimated(
        state=np.concatenate([position, velocity], axis=1),
        covariance=_of_both_axes(chain.covariance[row]),
        innovation=innovation,
        innovation_variance=np.broadcast_to(variance[:, None], innovation.shape),
    )


def _of_both_axes(covariance: Array) -> Array:
    """(steps, 2, 2) as (steps, 2, 2, 2), alike for both axes, without a copy."""
    steps = len(covariance)
    return np.broadcast_to(covariance[:, None], (steps, 2, 2, 2))


def _online(estimator: OnlineEstimator, sensors: Sensors, measured: Measurements) -> Estimated:
    positions = np.full_like(measured.specific_force, np.nan)
    positions[:: sensors.fix_interval] = measured.fixes
    found = estimator.run(np.ascontiguousarray(measured.specific_force), positions)
    return Estimated(
        state=found.state,
        covariance=_of_both_axes(found.covariance),
        innovation=found.innovation,
        innovation_variance=np.broadcast_to(
            found.innovation_variance[:, None], found.innovation.shape
        ),
    )


def _step_by_step(estimator: Estimator, sensors: Sensors, measured: Measurements) -> Estimated:
    steps, M = len(measured.specific_force), sensors.fix_interval
    due = np.all(np.isfinite(measured.fixes), axis=1)
    state = np.empty((steps, 4))
    covariance = np.full((steps, 2, 2, 2), np.nan)
    innovation, variance = np.full((2, steps, 2), np.nan)
    for k in range(steps):
        fix = measured.fixes[k // M] if k % M == 0 and due[k // M] else None
        found: Any = estimator.update(measured.specific_force[k], fix)
        if not isinstance(found, Estimate):
            raise TypeError(f"update gave a {type(found).__name__}, not an owtsweep.Estimate")
        state[k, :2], state[k, 2:] = found.position, found.velocity
        if found.covariance is not None:
            both = np.asarray(found.covariance).reshape(2, 2, 2, 2)  # (p, v) x (x, y), twice
            covariance[k] = np.einsum("iaja->aij", both)
        if found.innovation is not None:
            innovation[k] = found.innovation.value
            variance[k] = np.diagonal(found.innovation.covariance)
    if not np.all(np.isfinite(state)):
        step = int(np.argmax(~np.isfinite(state).all(axis=1)))
        raise ValueError(f"the estimate of step {step} is not finite")
    return Estimated(
        state,
        covariance if np.any(np.isfinite(covariance)) else None,
        innovation if np.any(np.isfinite(innovation)) else None,
        variance if np.any(np.isfinite(innovation)) else None,
    )
