"""Runs schemes as on board: each IMU sample gives one estimate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from owtsweep.studies.hub.contract import Estimator


#: The sensors and the tuning of an estimator whose user names none.
DEFAULTS = ("tuning=matched", "sensors=strong_bias")


def online(
    scheme: str, overrides: Sequence[str] = (), *, origin: ArrayLike | None = None
) -> Estimator:
    """Make an estimator that runs on board: each IMU sample gives one estimate.

    Its method is `update(specific_force, position=None) -> Estimate`. Position fixes may be
    missing: gains and covariances follow the fixes that arrived. On a machine, the first estimator
    takes some 15 s to make, in which its kernels are compiled.

    scheme: EKF, MKF, HME1, HME2, SKF, SKFA or SWITCH. SKF and SKFA need the origin, SKF the motion
        too: see the keys of the section `skf`.
    overrides: the sensors and the tuning, as on the command line, e.g. `["tuning=paper",
        "sensors.gnss.delay=0.3"]`. Without an override, the tuning is `matched`.
    origin: the point about which the scheme starts from zero, x and y in m, in the coordinates of
        the fixes; it must lie near the hub. None stands for the first fix: until it comes,
        estimates are NaN. Estimates are in the coordinates of the fixes for any origin.
    Raises InputError if the scheme cannot run on board, or the overrides or the origin are wrong.
    """
    from owtsweep.studies import compose
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.studies.hub.contract import Known
    from owtsweep.studies.hub.listed import resolve
    from owtsweep.studies.hub.sensors import sensors
    from owtsweep.studies.registry import require_texts

    registered = resolve(scheme)
    if not registered.on_board:
        raise InputError(
            f"scheme: {scheme!r} has no online form; use EKF, MKF, HME1, HME2, SKF, SKFA or SWITCH"
        )
    require_texts(overrides)
    given = {override.partition("=")[0] for override in overrides}
    ours = [word for word in DEFAULTS if word.partition("=")[0] not in given]
    config = compose([*ours, *overrides, f"schemes=[{scheme}]"])
    if not isinstance(config, HubConfig):
        raise InputError(f"study: {config.study!r} has no schemes to run online; use study=hub")
    return registered.stream(Known(sensors(config.sensors), config), origin)
