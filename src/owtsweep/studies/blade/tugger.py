"""Tugger lines: ropes with winches that hold the heading and the pitch of a hanging blade."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from owtsweep.studies.blade.sections import Freedom


def hold(freedom: Freedom, stiffness: float, damping: float) -> tuple[float, float, float, float]:
    """Return period, damping ratio, size and gusts of a freedom that lines hold.

    The lines are a spring and a damper beside those of the hook; the wind pushes as before. Then
    the natural frequency is sqrt(1 + k) times what it was, and the variance of a resonance under
    white noise falls with damping constant times stiffness, that of gusts, which are slow, with the
    square of the stiffness.

    Parameters
    ----------
    freedom
        The degree of freedom without lines.
    stiffness
        Stiffness of the lines over that of the hook, k.
    damping
        Damping ratio that the lines would add without their stiffness.
    """
    stiffer, damper = 1.0 + stiffness, 1.0 + damping / freedom.damping
    return (
        freedom.period / math.sqrt(stiffer),
        freedom.damping * damper / math.sqrt(stiffer),
        freedom.sigma / math.sqrt(damper * stiffer),
        freedom.gust / stiffer,
    )
