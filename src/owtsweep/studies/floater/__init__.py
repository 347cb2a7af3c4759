"""The floater study: position and velocity of a floating structure in a basin, for its actuators.

Kinematic estimators in six degrees of freedom, after Mehammer et al. (2018).
"""

from __future__ import annotations

from owtsweep import estimation, evaluation, motion, sensing, waves
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.sweep.study import Lever, add_versions, halve, halve_whole

__all__ = ["FloaterStudy"]


class FloaterStudy(DeclaredStudy):
    """The study of a floating structure in a basin."""

    name = "floater"
    levers = (
        Lever("half the noise of the optical system", "grid.snr", lambda snr: snr + 6.02),
        Lever("half the delay of the optical system", "grid.delay", halve_whole),
        Lever("half the lost reports", "grid.loss", halve),
        Lever("half the bias of the accelerometers", "grid.bias", halve),
    )
    stretched = ("position", 2, "heave (m)")
    numerics_version = add_versions(2, waves, sensing, motion, estimation, evaluation)
    commands = DeclaredStudy.commands | {"tune"}
