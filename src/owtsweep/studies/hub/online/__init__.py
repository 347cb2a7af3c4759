"""Runs schemes as on board: each IMU sample gives one estimate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.errors import InputError

if TYPE_CHECKING:
    from owtsweep.studies.hub.online.estimator import OnlineEstimator


def online(scheme: str, overrides: Sequence[str] = ()) -> OnlineEstimator:
    """Make an estimator that runs on board: each IMU sample gives one estimate.

    Parameters
    ----------
    scheme
        EKF, MKF, HME1 or HME2.
    overrides
        Settings of the sensors and the tuning, as on the command line, e.g. `["tuning=matched",
        "sensors.gnss.delay=0.3"]`.

    Returns
    -------
    OnlineEstimator
        Has the method `update(specific_force, position=None) -> Estimate`. Position fixes may be
        missing: gains and covariances follow the fixes that arrived. On each machine, the first
        estimator takes half a minute to compile its kernels.

    Raises
    ------
    InputError
        If the scheme cannot run on board, or an override is wrong.
    """
    from owtsweep.studies import compose
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.studies.hub.schemes import resolve
    from owtsweep.studies.hub.sensors import sensors

    registered: Any = resolve(scheme)
    if not hasattr(registered, "stream"):
        raise InputError(f"scheme: {scheme!r} has no online form; use EKF, MKF, HME1 or HME2")
    if not isinstance(overrides, str):  # a string is refused below
        overrides = [*overrides, f"schemes=[{scheme}]"]
    config = compose(overrides)
    if not isinstance(config, HubConfig):
        raise InputError(f"study: {config.study!r} has no schemes to run online; use study=hub")
    estimator: OnlineEstimator = registered.stream(sensors(config.sensors), config)
    return estimator
