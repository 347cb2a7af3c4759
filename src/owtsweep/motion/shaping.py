"""Fits a shaping filter: a linear system that turns white noise into motion of a given spectrum.

A Kalman filter can hold the states of such a system, and so know the spectrum. The fit minimises
the Itakura-Saito divergence of the fitted spectrum plus a floor from the given spectrum plus that
floor. The floor is the density below which the sensors see nothing of the motion. An estimator
that believes in a spectrum that is slightly wrong has an excess error in proportion to this
divergence: Weissman (2010), "The relationship between causal and noncausal mismatched estimation
in continuous-time AWGN channels", IEEE Trans. Inf. Theory 56(9), for white noise on a signal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.second_order_sections import Sections

#: Fewest and most states. Three poles more than zeros make the acceleration a sum of states; four
#: poles leave one zero. With more states than the most, the search finds no closer fit.
FEWEST, MOST = 4, 24
#: Greatest sum of the variances of the single resonances, m^2, where their sum has 1 m^2. Beyond
#: it the resonances cancel each other, and rounding is felt.
CANCELLATION = 1e8
#: Most evaluations of the fitted spectrum, for each start of the search.
EVALUATIONS = 150


@dataclass(frozen=True)
class ShapingFilter:
    """The system x' = A x + B w, driven by white noise w; its position has a variance of 1 m^2.

    The noise w has unit intensity: the mean of w(t) w(s) is the delta function of t - s, so the
    covariance of the noise over a step T is about B B' T. Multiply B by a standard deviation in m
    for motion of this standard deviation. A is stable. Velocity and acceleration are the exact
    derivatives of the position, and linear in the states: neither the position nor the velocity
    contains the noise w directly, and nor does the acceleration.

    Attributes
    ----------
    A
        System matrix, s^-1, shape (states, states). It consists of 2 x 2 blocks on the diagonal,
        one per resonance; each block is [[-d, w], [-w, -d]].
    B
        Input, shape (states,). The stationary variance of a state is near 1.
    position, velocity, acceleration
        Rows that give the motion from the states, in m, m/s and m/s^2, shape (states,) each.
    error
        The integral over the frequency (Hz) of r - log r - 1, in s^-1, where r is (given density +
        floor) / (this filter's density + floor): zero for a perfect fit. For white noise on the
        motion it is the Kullback-Leibler divergence of the two models per second of measurements.
    """

    A: Array
    B: Array
    position: Array
    velocity: Array
    acceleration: Array
    error: float

    def density(self, frequency: Array) -> Array:
        """Compute the one-sided density of the position, m^2/Hz, at frequencies in Hz, (m,)."""
        s = 2j * np.pi * frequency[:, None, None]
        states = np.linalg.solve(s * np.eye(len(self.B)) - self.A, self.B[:, None])[..., 0]
        return np.asarray(2.0 * np.abs(states @ self.position) ** 2)


def fit_shaping_filter(
    frequency: Array, density: Array, states: int, floor: Array | float
) -> ShapingFilter:
    """Fit a shaping filter to a one-sided spectral density of position.

    The filter has a pair of poles for every two states, two pairs of zeros less, and one real zero.

    Parameters
    ----------
    frequency
        Frequencies in Hz, above zero and increasing, shape (m,). They should reach well beyond the
        band of the motion, and be closer to each other than the width of the spectrum's peak.
    density
        Density at these frequencies, shape (m,). Its scale does not matter: it is divided by its
        integral. It may be zero outside a band.
    states
        Number of states, even.
    floor
        Density that the sensors' noise has as a position, divided by the variance of the motion,
        Hz^-1: a number or an array of shape (m,). The fit is close where the density is above it.

    Raises
    ------
    InputError
        If the frequencies or densities make no spectrum, the floor is not above zero, or a filter
        of so many states does not exist or is badly conditioned.
    """
    from scipy.optimize import least_squares

    frequency, density = np.asarray(frequency, float), np.asarray(density, float)
    floor = np.broadcast_to(np.asarray(floor, float), frequency.shape)
    _check(frequency, density, states, floor)
    width = np.gradient(frequency)
    density = density / np.sum(density * width)
    target = density + floor
    sections = Sections(frequency, width, states)

    def residuals(free: Array) -> Array:
        log_ratio = np.log(target / (sections.density(free) + floor))
        return np.sqrt(width) * _signed_root(log_ratio)

    def slopes(free: Array) -> Array:
        fitted = sections.density(free)
        log_ratio = np.log(target / (fitted + floor))
        of_fitted = -np.sqrt(width) * _slope_of_root(log_ratio) / (fitted + floor)
        return np.asarray((sections.slopes(free, fitted) * of_fitted).T)

    best = None
    for start in sections.list_starts(density, floor):
        found = least_squares(
            residuals,
            start,
            slopes,
            bounds=sections.bounds(),
            x_scale="jac",
            max_nfev=EVALUATIONS,
        )
        if best is None or found.cost < best.cost:
            best = found
    return _realise(*sections.roots(best.x), frequency, target, floor)  # type: ignore[union-attr]


def _check(frequency: Array, density: Array, states: int, floor: Array) -> None:
    require(
        frequency.ndim == 1 and len(frequency) >= 16 and density.shape == frequency.shape,
        f"frequency, density: arrays of the shapes {frequency.shape} and {density.shape} make no "
        "spectrum; give two arrays of one length, 16 or more",
    )
    require(
        bool(
            np.all(np.isfinite(frequency)) and frequency[0] > 0 and np.all(np.diff(frequency) > 0)
        ),
        "frequency: the frequencies must be finite, above zero and increasing",
    )
    finite = bool(np.all(np.isfinite(density)))
    require(finite, "density: a density is infinite or not a number; give finite densities")
    least = int(np.argmin(density))
    require(
        bool(density[least] >= 0.0),
        f"density: the spectrum is negative, {density[least]:.3g} at {frequency[least]:.4g} Hz; "
        "a density must not be below zero",
    )
    require(bool(np.any(density > 0.0)), "density: the spectrum is zero everywhere")
    require(
        bool(np.all(np.isfinite(floor)) and np.all(floor > 0.0)),
        "floor: the floor must be finite and above zero at every frequency",
    )
    require(
        FEWEST <= states <= MOST and states % 2 == 0,
        f"states: a shaping filter cannot have {states} states; choose an even number from "
        f"{FEWEST} to {MOST} (with more than {MOST}, no closer fit is found)",
    )


def _signed_root(log_ratio: Array) -> Array:
    """Return the root of r - log r - 1 with the sign of log r, given log r: a smooth function."""
    return np.asarray(np.sign(log_ratio) * np.sqrt(np.maximum(np.expm1(log_ratio) - log_ratio, 0)))


def _slope_of_root(log_ratio: Array) -> Array:
    """Return the derivative of `_signed_root`; at log r = 0 it is the root of one half."""
    small = np.abs(log_ratio) < 1e-5
    safe = np.where(small, 1.0, log_ratio)
    return np.asarray(np.where(small, np.sqrt(0.5), np.expm1(safe) / (2.0 * _signed_root(safe))))


def _realise(
    poles: NDArray[np.complex128],
    zeros: NDArray[np.complex128],
    frequency: Array,
    target: Array,
    floor: Array,
) -> ShapingFilter:
    """Make the filter from the poles with an imaginary part above zero, and all zeros, in s^-1.

    A pole p = -d + i w with the residue r in the transfer function gives the two states of the
    block [[-d, w], [-w, -d]], of which the first has the input 0. `target` is the given density
    plus the floor.
    """
    from scipy.linalg import solve_continuous_lyapunov

    all_poles = np.concatenate([poles, poles.conj()])
    states = len(all_poles)
    A, B, position = np.zeros((states, states)), np.zeros(states), np.zeros(states)
    for i, pole in enumerate(poles):
        residue = np.prod(pole - zeros) / np.prod(pole - np.delete(all_poles, i))
        here, drive = slice(2 * i, 2 * i + 2), np.sqrt(-4.0 * pole.real)
        A[here, here] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
        B[2 * i + 1] = drive
        position[here] = np.array([-residue.imag, residue.real]) * 2.0 / drive
    covariance = solve_continuous_lyapunov(A, -np.outer(B, B))
    variance = float(position @ covariance @ position)
    blocks = [slice(i, i + 2) for i in range(0, states, 2)]
    single = sum(position[b] @ covariance[b, b] @ position[b] for b in blocks)
    if not (variance > 0.0 and single < CANCELLATION * variance):
        raise InputError(
            f"states: a shaping filter of {states} states is badly conditioned here: its "
            f"resonances cancel each other ({single / variance:.1e} m^2 of variance for a sum of "
            f"1 m^2, above {CANCELLATION:.0e}); choose fewer states"
        )
    position = position / np.sqrt(variance)
    velocity = position @ A
    filter = ShapingFilter(A, B, position, velocity, velocity @ A, 0.0)
    log_ratio = np.log(target / (filter.density(frequency) + floor))
    error = np.sum((np.expm1(log_ratio) - log_ratio) * np.gradient(frequency))
    return ShapingFilter(A, B, position, velocity, velocity @ A, float(error))
