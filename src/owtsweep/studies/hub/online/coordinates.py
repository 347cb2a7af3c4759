"""Checks what an online estimator is given, and says in whose coordinates it works.

The schemes of Ren et al. (2019) start from zero with a standard deviation of about a metre. So
positions far from zero, such as map coordinates, must be taken about an origin near the hub, which
is stated or the first fix.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.evaluation.loop import RecordEstimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.chain import Parts
from owtsweep.studies.hub.kernels.online_layout import OnlineEstimates
from owtsweep.studies.hub.sensors import Sensors

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


def start_at_first_fix(parts: Parts) -> Parts:
    """Raise the variance of the first position, so that the first fix alone decides the position.

    It is left where it already is at least `LEAST_RATIO` times that of a fix.
    """
    axis, mhe = parts.axis, parts.horizon
    first = _raise_variance(axis.initial_covariance, axis.position_variance)
    axis = replace(axis, initial_covariance=first)
    if mhe is not None:
        first = _raise_variance(mhe.initial_covariance, mhe.weights.fix_variance)
        mhe = replace(mhe, initial_covariance=first)
    return replace(parts, axis=axis, horizon=mhe)


def _raise_variance(covariance: Array, fix_variance: float) -> Array:
    raised: Array = np.array(covariance)
    raised[0, 0] = max(raised[0, 0], LEAST_RATIO * fix_variance)
    return raised


def make_estimates(steps: int, unknown: int = 0) -> OnlineEstimates:
    """Make arrays, NaN, for the estimates of some steps, before which there is no innovation.

    Nothing is known in the first `unknown` steps: their variances are infinite.
    """
    shapes: tuple[tuple[int, ...], ...] = (4,), (2, 2), (2,), ()
    out = OnlineEstimates(*(np.full((steps, *shape), np.nan) for shape in shapes))
    out.covariance[:unknown] = np.diag([np.inf, np.inf])
    return out


class LocatedEstimator(RecordEstimator):
    """A running estimator of the hub that works about an origin: one IMU sample at a time, or many.

    Fixes and estimates are in the caller's coordinates, e.g. of a map.

    origin: x and y in m, shape (2,); None for the first fix.
    """

    def __init__(self, sensors: Sensors, origin: Array | None) -> None:
        self._sensors, self._origin = sensors, origin
        self._force, self._fix = np.empty((1, 2)), np.empty((1, 2))

    @property
    def origin(self) -> Array | None:
        """The origin, m, shape (2,); None before the first fix, if that is the origin."""
        return None if self._origin is None else self._origin.copy()

    @property
    def step(self) -> float:
        """The IMU's sampling interval, s."""
        return self._sensors.step

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample and perhaps a position fix; return the estimate of the present state.

        specific_force: in the IMU's frame, m/s^2, shape (2,).
        position: the fix in NED, m, shape (2,). None (or two NaN) if there is no fix.
        Returns: position (m) and velocity (m/s) in NED, covariance (4, 4) of x, y, v_x, v_y, and
            the innovation of the position; None in its place if the filter took no position at this
            step. Where the origin is the first fix, position and velocity are NaN and their
            variances infinite until it comes.
        Raises ValueError if a sample is not two finite numbers, or a fix cannot be taken. The
        estimator is left unchanged.
        Raises ArithmeticError as `OnlineEstimator.run`.
        """
        check_sample(specific_force, position)
        self._force[0] = specific_force
        self._fix[0] = np.nan if position is None else position
        state, covariance, value, variance = (s[0] for s in self._run(self._force, self._fix))
        innovation = Innovation(value, variance) if value[0] == value[0] else None  # not NaN
        return Estimate(state[:2], state[2:], covariance, innovation)

    def run_record(self, specific_force: Array, positions: Array) -> Trajectory:
        """Take many samples, shape (steps, 2) each, as if `update` took each in turn.

        Both components of a position are NaN at steps without a fix. Raises ValueError and
        ArithmeticError as `update`, or ValueError if the shapes are wrong.
        """
        return Trajectory(*self._run(specific_force, positions))

    @abstractmethod
    def _run(self, specific_force: Array, positions: Array) -> tuple[Array, Array, Array, Array]:
        """Take samples; return what a `Trajectory` consists of, NaN at steps without innovation."""


def check_sample(specific_force: Array, position: Array | None) -> None:
    """Raise `ValueError` if what `update` is given is not two numbers each."""
    for name, value in (("specific_force", specific_force), ("position", position)):
        if value is not None and np.shape(value) != (2,):  # NumPy would use one number for both
            raise ValueError(f"{name}: {value!r} is not two numbers; give x and y")


def check_grid(scheme: str, steps: NDArray[np.intp], interval: int, begin: int = 0) -> None:
    """Raise ValueError if a fix comes at a step at which a scheme takes none: off its grid.

    interval, begin: IMU steps between two points of the grid, and its first point.
    """
    off = steps[(steps - begin) % interval != 0]
    if len(off):
        after = f" after the first one, at step {begin}" if begin else ""
        raise ValueError(
            f"position: a fix came at step {off[0]}, but {scheme} takes fixes only at multiples of "
            f"{interval} IMU steps{after}; give the fix at the next multiple, or leave the fix out"
        )


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
