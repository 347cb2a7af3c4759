"""Makes the models of SKF: a motion along one axis, of known spectrum and variance.

The shaping filters that are fitted to a spectrum are kept in memory and in the cache folder.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from threading import local
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.discretisation import Model, discretise
from owtsweep.io.cache import cached
from owtsweep.motion.shaping import ShapingFilter, fit_shaping_filter
from owtsweep.studies.hub.known_motion import KnownMotion, find_noise_density
from owtsweep.studies.hub.scheme_sections import Skf
from owtsweep.studies.hub.sensors import Sensors

if TYPE_CHECKING:
    from owtsweep.estimation.late import LateGains, LateModel

#: Longest transient that is stored, in steps (2621 s at 100 Hz); then the last rows are repeated.
LONGEST_TRANSIENT = 2**18
#: Least share of an axis in the variance of the motion. An axis without any motion would have a
#: covariance of zero, which cannot be inverted; so little is far below the error of an estimate.
LEAST_SHARE = 1e-6
#: Density at which the fit of the shaping filter still matters, as a share of what the sensors'
#: noise has as a position: the filter sees more than a single sample does. With a tenth, what SKF
#: states of its error is nearest to the truth.
FLOOR = 0.1


@dataclass(frozen=True, eq=False)
class SpectralAxis:
    """The model of SKF along one axis.

    model: its fast measurement is the specific force, its slow one a fix.
    first: covariance (N, N) of the state one step before step 0.
    outputs: rows (2, n) of position and velocity.
    """

    model: LateModel
    first: Array
    outputs: Array

    @cached_property
    def gains(self) -> LateGains:
        """The filter's gains; they take some 80 MB for records of 2000 s if they do not settle."""
        from owtsweep.estimation.late import LateGains

        return LateGains(self.model, self.first, self.outputs)


def make_axis(
    peaks: Sequence[tuple[ShapingFilter, float]],
    tuning: Skf,
    sensors: Sensors,
    red: float | None = None,
) -> SpectralAxis:
    """Make the model of one axis from the peaks of the spectrum.

    The specific force along the axis is f = a - g tilt p + b + noise, with acceleration a, position
    p and bias b, which includes gravity; see `Sensors.lean`. The IMU's white noise and that of
    fixes have the sensors' own variances.

    peaks: parts of the motion that do not depend on each other: the spectrum of each, as a shaping
        filter for a variance of 1 m^2, and its variance along the axis, m^2.
    red: standard deviation of the fixes' red noise, m; None: as the tuning says.
    """
    from scipy.linalg import block_diag, solve_continuous_lyapunov

    from owtsweep.estimation.late import LateModel, find_first_covariance

    A = block_diag(*(peak.A for peak, _ in peaks))
    intensity = block_diag(*(variance * np.outer(peak.B, peak.B) for peak, variance in peaks))
    position, velocity, acceleration = (
        np.concatenate([getattr(peak, name) for peak, _ in peaks])
        for name in ("position", "velocity", "acceleration")
    )
    n, step, delay = len(A), sensors.step, sensors.delay
    discrete = discretise(Model(A, np.zeros((n, 1)), intensity), step)
    blocks = np.array([discrete.A[i : i + 2, i : i + 2] for i in range(0, n, 2)])
    red = tuning.red_sigma or 0.0 if red is None else red
    fade = float(np.exp(-step / tuning.red_time))
    q_b = sensors.bias_walk**2 if tuning.q_b is None else tuning.q_b
    model = LateModel(
        A=blocks,
        Q=discrete.Q,
        walk=q_b * step,
        fast=acceleration - tuning.find_lean(sensors.lean) * position,
        slow=position.copy(),
        r_fast=sensors.force_sigma**2,
        r_slow=sensors.position_sigma**2,
        interval=sensors.fix_interval,
        delay=delay,
        copies=-(-delay // sensors.fix_interval),
        reds=int(red > 0.0),
        fade=fade,
        red=red**2 * (1.0 - fade**2),
    )
    stationary = solve_continuous_lyapunov(A, -intensity)
    first = find_first_covariance(model, stationary, tuning.bias_variance)
    return SpectralAxis(model, first, np.stack([position, velocity]))


class _Last(local):
    """What a thread made last, which it often needs again; more would take too much memory."""

    what: tuple[object, ...] | None = None
    axes: tuple[SpectralAxis, SpectralAxis]


_LAST = _Last()


def make_axes(
    known: KnownMotion, tuning: Skf, sensors: Sensors
) -> tuple[SpectralAxis, SpectralAxis]:
    """Make the models along x and y: one shaping filter, and the variance of each axis.

    The shaping filter is fitted where the motion's density is above what the sensors' noise has as
    a position, along the axis with the larger variance.
    """
    arrays = (known.frequency, known.density, known.variance)
    what = (*(array.tobytes() for array in arrays), repr(tuning), sensors)
    if _LAST.what != what:
        variance = np.maximum(known.variance, LEAST_SHARE * np.sum(known.variance))
        floor = FLOOR * find_noise_density(sensors, known.frequency) / np.max(variance)
        shaping = fit_or_recall(known.frequency, known.density, tuning.states, floor)
        x, y = (make_axis([(shaping, float(one))], tuning, sensors) for one in variance)
        _LAST.what, _LAST.axes = what, (x, y)
    return _LAST.axes


def fit_or_recall(frequency: Array, density: Array, states: int, floor: Array) -> ShapingFilter:
    """Do as `fit_shaping_filter`, or recall its result from the cache.

    `frequency` (Hz), `density` and `floor` (Hz^-1) have the shape (m,).
    """
    given = b"".join(np.ascontiguousarray(array).tobytes() for array in (frequency, density, floor))
    what = {"what": "shaping filter", "states": states, "given": blake2b(given).hexdigest()}

    def fit() -> dict[str, Array]:
        shape = fit_shaping_filter(frequency, density, states, floor)
        return {name: np.asarray(value) for name, value in vars(shape).items()}

    kept = cached(what, fit)
    rows = {name: array for name, array in kept.items() if name != "error"}
    return ShapingFilter(**rows, error=float(kept["error"]))
