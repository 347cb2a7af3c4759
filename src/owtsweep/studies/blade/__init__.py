"""The blade study: where a hoisted blade's root is, from GNSS and an inertial unit on it.

After Maes, De Roeck and Lombaert (2018).
"""

from __future__ import annotations

from owtsweep import estimation, evaluation, motion
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.sweep.study import Lever, add_versions, double, halve

__all__ = ["BladeStudy"]


class BladeStudy(DeclaredStudy):
    """The study of a hoisted blade."""

    name = "blade"
    levers = (
        Lever("half the noise of a GNSS fix", "grid.sigma", halve),
        Lever("twice as many GNSS fixes", "sensors.fix_rate", double, (2.5, 1.5, 3.0, 4.0, 5.0)),
        Lever("half the length of an outage", "grid.outage", halve),
        Lever("half the error of the time stamps", "grid.offset", halve),
        Lever("half the error of the lever arm", "grid.lever", halve),
        Lever("half the noise of the accelerometers", "unit.force_sigma", halve),
        Lever("half the bias of the accelerometers", "unit.force_bias", halve),
        Lever("half the noise of the gyroscopes", "unit.rate_sigma", halve),
    )
    stretched = ("root", 0, "position of the root, first axis (m)")
    numerics_version = add_versions(1, motion, estimation, evaluation)
    commands = DeclaredStudy.commands | {"tune"}
    most_samples = 100_000  # a filter keeps all its covariances
