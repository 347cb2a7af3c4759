"""Computes the bound of `known_spectrum` in a second way: by least squares on a window.

The covariance of all measurements in a window and of the present motion follows from the spectrum
by integrals. The best linear estimate of the motion is then a projection (Wiener). There is no
rational filter, no recursion and no steady state in this. The window must be long against the
memory of the motion and of the bias. It takes the cube of the number of samples: reduce the IMU's
rate, with a sigma smaller by the root of it, to keep a window short.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.known_motion import KnownMotion

#: Standard deviation of the bias at the start of the window: unknown, m/s^2.
BIAS_AT_START = 1.0


def bound_on_window(
    known: KnownMotion, variance: float, sensors: Sensors, seconds: float
) -> tuple[float, float]:
    """Compute the bounds along one axis, of position (m^2) and of velocity ((m/s)^2).

    Parameters
    ----------
    known
        The spectrum of the motion; its own variances are not used.
    variance
        Variance of the position along the axis, m^2.
    sensors
        The sensors; their AC coupling and scale of a fix are left out.
    seconds
        Length of the window, s.

    Returns
    -------
    tuple of float
        As `bound_of_known_spectrum`.
    """
    from scipy.linalg import cholesky, solve_triangular

    interval = sensors.fix_interval
    fixes = max(round(seconds / sensors.fix_step), 1)
    # the last `interval` steps are those at which estimates are made; a fix arrives at the first
    steps = np.arange(fixes * interval)
    arrivals = steps[::interval]
    arrival = np.concatenate([steps, arrivals])
    order = np.argsort(arrival, kind="stable")
    time = np.concatenate([steps, arrivals - sensors.delay])[order]
    is_fix = (np.arange(len(order)) >= len(steps))[order]

    lags = time[:, None] - time[None, :]
    least = min(int(lags.min()), int(time.min() - steps[-1]))
    table = _Covariances(known, variance, sensors, -least)
    K = np.where(
        is_fix[:, None] & is_fix,
        table.of("position", "position", lags),
        np.where(
            is_fix[:, None] | is_fix,
            table.of("force", "position", lags),  # even in the lag
            table.of("force", "force", lags),
        ),
    )
    earlier = np.minimum(time[:, None], time)[~is_fix][:, ~is_fix] * sensors.step
    K[np.ix_(~is_fix, ~is_fix)] += BIAS_AT_START**2 + sensors.bias_walk**2 * earlier
    K[np.diag_indices_from(K)] += np.where(
        is_fix, sensors.position_sigma**2, sensors.force_sigma**2
    )
    L = cholesky(K, lower=True)
    errors = []
    for now in steps[-interval:]:
        count = np.count_nonzero(arrival <= now)
        ago = now - time[:count]
        for target in ("position", "velocity"):
            g = np.where(
                is_fix[:count], table.of(target, "position", ago), table.of(target, "force", ago)
            )
            seen = solve_triangular(L[:count, :count], g, lower=True)
            errors.append(table.of(target, target, np.zeros(1, int))[0] - seen @ seen)
    position, velocity = np.reshape(errors, (interval, 2)).mean(axis=0)
    return float(position), float(velocity)


class _Covariances:
    """Covariances of position, velocity and what the IMU feels, over the lag in steps."""

    def __init__(self, known: KnownMotion, variance: float, sensors: Sensors, most: int) -> None:
        omega = 2.0 * np.pi * known.frequency
        phase = np.outer(np.arange(most + 1) * sensors.step, omega)
        weight = variance * known.density * known.spacing
        force = -(omega**2) - sensors.lean
        cos, sin = np.cos(phase), np.sin(phase)
        #: Covariance of the first at t + lag with the second at t, for lags from 0 on.
        self.even = {
            ("position", "position"): cos @ weight,
            ("force", "position"): cos @ (weight * force),
            ("force", "force"): cos @ (weight * force**2),
            ("velocity", "velocity"): cos @ (weight * omega**2),
        }
        self.even["position", "force"] = self.even["force", "position"]
        self.odd = {
            ("velocity", "position"): -sin @ (weight * omega),
            ("velocity", "force"): -sin @ (weight * omega * force),
        }

    def of(self, first: str, second: str, lag: Array) -> Array:
        """Return the covariance of `first` with `second` `lag` steps before it, shape of `lag`."""
        if (first, second) in self.even:
            return np.asarray(self.even[first, second][np.abs(lag)])
        return np.asarray(np.sign(lag) * self.odd[first, second][np.abs(lag)])
