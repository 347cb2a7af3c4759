"""Joins a record of the blade study with one of the hub study: their relative motion.

The blade's frame has x along the blade and z up. We let its x point north, so its y points west;
the hub moves horizontally. A root at its reference and a hub at rest are together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Config
from owtsweep.errors import InputError
from owtsweep.evaluation.estimate import EstimatedRecord
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.registry import compose, get_study

#: From north and east to the axes of the blade's frame: north, west, up.
TO_BLADE = np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])


class Relative(NamedTuple):
    """The motion of the root relative to the hub.

    `position`, `velocity`: in m and m/s, shape (steps, 3); the position is zero where they are
    together. `covariance`: of the error of the position, m^2, shape (steps, 3, 3); None for a
    truth, or if one of both estimates states none.
    """

    position: Array
    velocity: Array
    covariance: Array | None = None


def configure_blade(
    config: MatingConfig, sigma: float, outage: float, schemes: Sequence[str]
) -> Config:
    """Return the configuration of the blade study in a cell.

    Raise `InputError` if an override of the key `blade` is wrong.
    """
    record = config.record
    return _compose(
        "blade",
        (
            *config.blade, f"seed={config.seed}", f"tuning={config.tuning}",
            f"grid.sigma=[{sigma}]", f"grid.outage=[{outage}]", f"schemes=[{','.join(schemes)}]",
            f"record.duration={record.duration}", f"record.rate={record.rate}",
            f"record.settling={record.settling}",
        ),
    )  # fmt: skip


def configure_hub(config: MatingConfig, sigma: float) -> Config:
    """Return the configuration of the hub study in a cell.

    Raise `InputError` if an override of the key `hub` is wrong.
    """
    return _compose(
        "hub",
        (
            *config.hub, f"seed={config.seed}", f"tuning={config.tuning}",
            f"sensors.gnss.sigma={sigma}", f"schemes=[{config.hub_scheme}]", "baselines=[]",
            f"record.duration={config.record.duration}",
            f"measures.settling_time={config.record.settling}",
        ),
    )  # fmt: skip


@lru_cache(maxsize=64)
def _compose(study: str, overrides: tuple[str, ...]) -> Config:
    try:
        return compose([f"study={study}", *overrides])
    except InputError as error:
        raise InputError(f"{study}: {error}") from None


def estimate(config: Config, replicate: int) -> EstimatedRecord:
    return get_study(config.study).estimate(config, replicate)


def find_true_motion(blade: EstimatedRecord, hub: EstimatedRecord) -> Relative:
    """Return how the root truly moves relative to the hub."""
    return _subtract(blade, blade.truth, hub, hub.truth)


def find_estimated_motion(
    blade: EstimatedRecord, scheme: str, hub: EstimatedRecord, hub_scheme: str
) -> Relative:
    """Return how the root moves relative to the hub, as one scheme each says.

    Errors of both estimates are taken to be independent: so are their sensors.
    """
    estimated = _subtract(blade, blade.estimates[scheme], hub, hub.estimates[hub_scheme])
    of_root = blade.covariances[scheme].get("root")
    of_hub = hub.covariances[hub_scheme].get("position")
    if of_root is None or of_hub is None:
        return estimated
    covariance = of_root + TO_BLADE @ of_hub[_match(blade, hub)] @ TO_BLADE.T
    return estimated._replace(covariance=covariance)


def _subtract(
    blade: EstimatedRecord,
    root: Mapping[str, Array],
    hub: EstimatedRecord,
    moved: Mapping[str, Array],
) -> Relative:
    at = _match(blade, hub)
    return Relative(
        root["root"] - blade.at_rest["root"] - moved["position"][at] @ TO_BLADE.T,
        root["root_velocity"] - moved["velocity"][at] @ TO_BLADE.T,
    )


def _match(blade: EstimatedRecord, hub: EstimatedRecord) -> slice[int]:
    """Return which samples of the hub's record are those of the blade's."""
    every = round(float(blade.time[1] / hub.time[1]))
    return slice(0, every * len(blade.time), every)
