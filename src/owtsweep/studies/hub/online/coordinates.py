"""Checks what an online estimator is given, and says in whose coordinates it works.

The schemes of Ren et al. (2019) start from zero with a standard deviation of about a metre. So
positions far from zero, such as map coordinates, must be taken about an origin near the hub, which
is stated or the first fix.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub.horizon import Horizon
from owtsweep.studies.hub.kernels.online_layout import OnlineEstimates
from owtsweep.studies.hub.models import AxisFilter

#: Largest distance in m of the first fix from a stated origin: no motion goes so far, so the fixes
#: are in coordinates of a map and the origin is not.
FARTHEST = 1e5
#: Least ratio of the first position's variance to the variance of a fix, if the first fix is the
#: origin. Nothing but this fix tells where the hub is. The filter weighs the fix with the first
#: position's variance, so it states a variance that is too small by a part of 1 / LEAST_RATIO.
LEAST_RATIO = 100.0


def check_origin(origin: object) -> Array | None:
    """Return the origin as an array (2,) in m, or None for the first fix.

    Raises InputError if the origin is neither None nor two finite numbers.
    """
    if origin is None:
        return None
    wrong = f"origin: {origin!r} is not two finite numbers; give x and y in m, e.g. origin=(0, 0)"
    try:
        point = np.array(origin, dtype=float)
    except (TypeError, ValueError):
        raise InputError(wrong) from None
    if point.shape != (2,) or not np.isfinite(point).all():
        raise InputError(wrong)
    return point


def start_at_first_fix(axis: AxisFilter, mhe: Horizon | None) -> tuple[AxisFilter, Horizon | None]:
    """Raise the variance of the first position, so that the first fix alone decides the position.

    It is left where it already is at least `LEAST_RATIO` times that of a fix.
    """
    first = _raise_variance(axis.initial_covariance, axis.position_variance)
    axis = replace(axis, initial_covariance=first)
    if mhe is not None:
        first = _raise_variance(mhe.initial_covariance, mhe.weights.fix_variance)
        mhe = replace(mhe, initial_covariance=first)
    return axis, mhe


def _raise_variance(covariance: Array, fix_variance: float) -> Array:
    raised: Array = np.array(covariance)
    raised[0, 0] = max(raised[0, 0], LEAST_RATIO * fix_variance)
    return raised


def make_estimates(steps: int, unknown: int = 0) -> OnlineEstimates:
    """Make arrays for the estimates of some steps; nothing is known in the first `unknown` steps.

    In these the state is NaN, the variances are infinite, and there is no innovation. The values of
    the other steps are still to be filled.
    """
    out = OnlineEstimates(
        np.empty((steps, 4)), np.empty((steps, 2, 2)), np.empty((steps, 2)), np.empty(steps)
    )
    if unknown:
        for series in (out.state, out.innovation, out.innovation_variance):
            series[:unknown] = np.nan
        out.covariance[:unknown] = np.diag([np.inf, np.inf])
    return out


def check_sample(specific_force: Array, position: Array | None) -> None:
    """Raise `ValueError` if what `update` is given is not two numbers each."""
    for name, value in (("specific_force", specific_force), ("position", position)):
        if value is not None and np.shape(value) != (2,):  # NumPy would use one number for both
            raise ValueError(f"{name}: {value!r} is not two numbers; give x and y")


def check_samples(force: Array, positions: Array, first: int) -> NDArray[np.intp]:
    """Return which of some samples have a fix; `first` is the step of the first sample.

    Raises ValueError if the shapes are wrong, a number is infinite, a specific force is NaN, or
    only one component of a fix is NaN.
    """
    if force.ndim != 2 or force.shape[1] != 2 or force.shape != positions.shape:
        raise ValueError(
            f"specific_force, positions: their shapes are {force.shape} and {positions.shape}; "
            "give both the shape (steps, 2)"
        )
    if not np.isfinite(force).all():
        step = first + int(np.argmax(~np.isfinite(force).all(axis=1)))
        raise ValueError(
            f"specific_force: it is not finite at step {step}; give two finite numbers"
        )
    there = positions == positions  # not NaN
    if there.any() and (not np.array_equal(there[:, 0], there[:, 1]) or np.isinf(positions).any()):
        raise ValueError(
            "position: a fix has a component that is missing or infinite; give both components as "
            "finite numbers, or leave the fix out"
        )
    return np.flatnonzero(there[:, 0])
