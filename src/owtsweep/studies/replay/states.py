"""What the filters believe besides position and velocity: acceleration and bias."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.session import Session


@dataclass(frozen=True)
class FilterStates:
    """(steps, 2) in m/s^2, NED, each at the moment that it is about; NaN where none is.

    `acceleration` is None for a model without that state; `bias` is R b^b.
    """

    acceleration: Array | None
    bias: Array


def filter_states(config: ReplayConfig, session: Session) -> dict[str, FilterStates]:
    """Scheme -> its filter's states; empty where fixes are missing (kernels need every one)."""
    measured, sensors = session.measured, session.sensors
    if not np.all(np.isfinite(measured.fixes)):
        return {}
    force = np.ascontiguousarray(measured.specific_force @ sensors.rotation.T)
    fixes = np.ascontiguousarray(measured.fixes)
    result = {}
    for scheme in resolve_all(config.schemes, config):
        if scheme.name not in session.estimated or not hasattr(scheme, "kernel"):
            continue
        chain = scheme.kernel(sensors, config, len(force))
        known = batch.states(chain, force, fixes)
        lag = chain.filter.input_delay + chain.filter.window
        moved = np.full_like(known, np.nan)
        moved[: len(known) - lag] = known[lag:]
        has_acceleration = bool(np.any(chain.axis.force_row))
        result[scheme.name] = FilterStates(
            acceleration=moved[:, 2] if has_acceleration else None,
            bias=np.array(sensors.gravity) - moved[:, 3],
        )
    return result
