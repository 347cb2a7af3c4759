"""Schemes as they run on board: each IMU sample gives one estimate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.errors import InputError

if TYPE_CHECKING:
    from owtsweep.studies.hub.contract import Sensors
    from owtsweep.studies.hub.online.estimator import OnlineEstimator

__all__ = ["Streaming", "online"]


def online(scheme: str, overrides: Sequence[str] = ()) -> OnlineEstimator:
    """A scheme to run on board: feed it one IMU sample at a time.

    Parameters
    ----------
    scheme
        EKF, MKF, HME1 or HME2.
    overrides
        The sensors and the tuning, as on the command line, e.g. `["tuning=matched",
        "sensors.gnss.delay=0.3"]`.

    Returns
    -------
    OnlineEstimator
        With `update(specific_force, position=None) -> Estimate`. Fixes may be missing: gains and
        covariances follow the fixes that arrived. The first estimator on a machine takes half a
        minute to compile its kernels.

    Raises
    ------
    InputError
        If the scheme cannot run on board, or the overrides are wrong.
    """
    from owtsweep.studies import compose
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.studies.hub.sensors import sensors

    streaming = Streaming(scheme)
    if not isinstance(overrides, str):  # a string is refused below
        overrides = [*overrides, f"schemes=[{scheme}]"]
    config = compose(overrides)
    if not isinstance(config, HubConfig):
        raise InputError(f"study: {config.study!r} has no schemes to run online; use study=hub")
    return streaming.start(sensors(config.sensors), config)


class Streaming:
    """A registered scheme whose `start` makes its online form, for tests and for `schemes`."""

    def __init__(self, scheme: str) -> None:
        from owtsweep.studies.hub.schemes import resolve

        self._scheme: Any = resolve(scheme)
        if not hasattr(self._scheme, "stream"):
            raise InputError(f"scheme: {scheme!r} has no online form; use EKF, MKF, HME1 or HME2")
        self.name: str = self._scheme.name
        self.linear: bool = self._scheme.linear

    def under(self, tuning: Any) -> Streaming:
        """The form for a tuning: with constraints the scheme is not linear."""
        from owtsweep.studies.hub.schemes import under

        made = Streaming(self.name)
        made.linear = under(self._scheme, tuning).linear
        return made

    def start(self, sensors: Sensors, tuning: Any) -> OnlineEstimator:
        """Make a fresh estimator."""
        estimator: OnlineEstimator = self._scheme.stream(sensors, tuning)
        return estimator
