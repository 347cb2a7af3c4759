"""When two bodies can be joined: they stay close, and slow to each other, for some time.

Our own; Ren et al. (2019) and Maes et al. (2018) end before the mating.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array


class Limits(NamedTuple):
    """What a mating allows.

    Attributes
    ----------
    distance
        Largest distance from the place of mating, m.
    speed
        Largest relative speed, m/s.
    hold
        Number of samples for which both must hold, the first among them.
    """

    distance: float
    speed: float
    hold: int


class Chances(NamedTuple):
    """Shares of the moments of a record.

    Attributes
    ----------
    true
        At which the bodies can be joined.
    told
        At which the estimates say so.
    wrong
        At which the estimates are wrong about it, in either way.
    missed
        Of the true chances, the share that estimates do not tell; NaN without a chance.
    false
        Of the told chances, the share that is none; NaN if none is told.
    """

    true: float
    told: float
    wrong: float
    missed: float
    false: float


def find_chances(apart: Array, velocity: Array, limits: Limits) -> NDArray[np.bool_]:
    """Return at which moments a mating may begin, shape (steps - hold + 1,).

    It may if the bodies keep within the limits from the moment on, for `limits.hold` samples.

    Parameters
    ----------
    apart
        Distance of the bodies from the place of mating in m, shape (steps, axes).
    velocity
        Their relative velocity in m/s, shape (steps, axes).
    limits
        What the mating allows.

    Raises
    ------
    ValueError
        If the record is shorter than `limits.hold`.
    """
    if len(apart) < limits.hold:
        raise ValueError(f"{len(apart)} samples are fewer than the {limits.hold} of a mating")
    near = np.sum(apart**2, axis=1) <= limits.distance**2
    slow = np.sum(velocity**2, axis=1) <= limits.speed**2
    count = np.concatenate([[0], np.cumsum(near & slow)])
    return np.asarray(count[limits.hold :] - count[: -limits.hold] == limits.hold)


def compare_chances(true: NDArray[np.bool_], told: NDArray[np.bool_]) -> Chances:
    """Compare the moments at which a mating may begin with those of which estimates say so."""
    both = float(np.mean(true & told))
    is_true, is_told = float(np.mean(true)), float(np.mean(told))
    return Chances(
        true=is_true,
        told=is_told,
        wrong=float(np.mean(true != told)),
        missed=1.0 - both / is_true if is_true > 0.0 else float("nan"),
        false=1.0 - both / is_told if is_told > 0.0 else float("nan"),
    )
