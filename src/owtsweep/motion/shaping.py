"""Fits a shaping filter: a linear system that turns white noise into motion of a given spectrum.

A Kalman filter can hold the states of such a system, and so know the spectrum. The fit minimises
the Itakura-Saito divergence of the fitted spectrum plus a floor from the given spectrum plus that
floor. The floor is the density below which the sensors see nothing of the motion. An estimator that
assumes a slightly wrong spectrum has an excess error in proportion to this divergence: Weissman
(2010), "The relationship between causal and noncausal mismatched estimation in continuous-time AWGN
channels", IEEE Trans. Inf. Theory 56(9), for white noise on a signal.

Spectral densities are computed from the roots of second-order sections. A section is (s + d)^2 +
w^2, which has the roots -d + i w and -d - i w. The denominator of a filter is a product of
sections. The numerator is a product of two sections less, times s + c with a real c. So the filter
has three poles more than zeros.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: Least decay d of zeros, s^-1; zeros without decay take the density to zero at their frequency.
LEAST_DECAY = 1e-5
#: Fewest and most states. Three poles more than zeros make the acceleration a sum of states; four
#: poles leave one zero. With more states than the most, the search finds no closer fit.
FEWEST, MOST = 4, 24
#: Greatest sum of the variances of the single resonances, m^2, where their sum has 1 m^2. Beyond
#: it the resonances cancel each other, and rounding is felt.
CANCELLATION = 1e8
#: Most evaluations of the fitted spectrum, for each start of the search.
EVALUATIONS = 150


@dataclass(frozen=True)
class Sections:
    """The densities of the filters of one order at given frequencies, over their free numbers.

    The free numbers of a filter are log w and log d of each section, those of the poles first, and
    log c at the end; shape (2 states - 3,). All of w, d and c are in s^-1.

    frequency, width: Frequencies, increasing, and the width of the interval that each stands for in
        integrals, Hz, shape (m,) each.
    states: Number of poles: even, four or more.
    """

    frequency: Array
    width: Array
    states: int

    @property
    def poles(self) -> int:
        """The number of sections of the denominator; the numerator has two less."""
        return self.states // 2

    def bounds(self) -> tuple[Array, Array]:
        """Return bounds of the free numbers, between which the frequencies show the resonances."""
        slowest, fastest = 2.0 * np.pi * self.frequency[[0, -1]]
        least, greatest = np.empty((2, 2 * self.poles - 2, 2))
        least[:, 0], greatest[:, :] = slowest, fastest
        least[: self.poles, 1] = np.pi * self.width.min()
        least[self.poles :, 1] = LEAST_DECAY
        return np.log(np.append(least, 1e-2 * slowest)), np.log(np.append(greatest, fastest))

    def density(self, free: Array) -> Array:
        """Compute the density, shape (m,), scaled so that its integral is 1."""
        omega2 = (2.0 * np.pi * self.frequency) ** 2
        density = omega2 + np.exp(2.0 * free[-1])
        for sign, w, d in self._factors(free):
            size = (w**2 + d**2 - omega2) ** 2 + 4.0 * d**2 * omega2
            density = density / size if sign < 0.0 else density * size
        return np.asarray(density / np.sum(density * self.width))

    def slopes(self, free: Array, density: Array) -> Array:
        """Compute the derivatives of `density` by the free numbers, shape (free numbers, m)."""
        omega2 = (2.0 * np.pi * self.frequency) ** 2
        rows = []
        for sign, w, d in self._factors(free):
            away, damped = w**2 + d**2 - omega2, 4.0 * d**2 * omega2
            factor = sign / (away**2 + damped)
            rows += [factor * 4.0 * away * w**2, factor * (4.0 * away * d**2 + 2.0 * damped)]
        rows.append(2.0 / (1.0 + omega2 * np.exp(-2.0 * free[-1])))
        logarithmic = np.array(rows)
        means = logarithmic @ (density * self.width)  # the scaling keeps the integral at 1
        return np.asarray(density * (logarithmic - means[:, None]))

    def roots(self, free: Array) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return the poles with an imaginary part above zero, and all zeros, in s^-1.

        The shapes are (states / 2,) and (states - 3,).
        """
        upper = np.array([complex(-d, w) for _, w, d in self._factors(free)])
        poles, zeros = upper[: self.poles], upper[self.poles :]
        return poles, np.concatenate([zeros, zeros.conj(), [-np.exp(free[-1])]])

    def list_starts(self, density: Array, floor: Array) -> list[Array]:
        """Return values of the free numbers to start a search from: two ways to spread the poles.

        A resonance stands at the peak of `density` (m,). The others are spread over the band in
        which it is not far below `floor` (m,), with zeros at the band's edges and between the
        poles.
        """
        seen = self.frequency[density > np.minimum(0.1 * floor, 1e-4 * density.max())]
        first, last = seen[0], max(seen[-1], 1.2 * seen[0])
        peak = self.frequency[np.argmax(density)]
        half = 0.5 * np.sum(self.width[density > 0.5 * density.max()])
        starts = []
        for spread in (np.geomspace, np.linspace):
            at = spread(first, last, self.poles)
            nearest = np.argmin(np.abs(at - peak))
            at[nearest] = peak
            decay = 0.15 * at
            decay[nearest] = half
            between = np.sqrt(at[1:] * at[:-1])
            zeros = np.concatenate([[1.15 * last, 0.8 * first], between])[: self.poles - 2]
            decay_of_zeros = zeros * np.where(np.arange(len(zeros)) < 2, 0.02, 0.1)
            sections = [np.append(at, zeros), np.append(decay, decay_of_zeros)]
            free = np.log(2.0 * np.pi * np.append(np.transpose(sections), 0.5 * first))
            least, greatest = self.bounds()
            starts.append(np.clip(free, least + 1e-6, greatest - 1e-6))
        return starts

    def _factors(self, free: Array) -> list[tuple[float, float, float]]:
        """Return of each section the sign of its power, -1 or 1, w and d (s^-1)."""
        pairs = np.exp(free[:-1].reshape(-1, 2))
        return [(-1.0 if i < self.poles else 1.0, w, d) for i, (w, d) in enumerate(pairs.tolist())]


@dataclass(frozen=True)
class ShapingFilter:
    """The system x' = A x + B w, driven by white noise w; its position has a variance of 1 m^2.

    The noise w has unit intensity: the mean of w(t) w(s) is the delta function of t - s, so the
    covariance of the noise over a step T is about B B' T. Multiply B by a standard deviation in m
    for motion of this standard deviation. A is stable. Velocity and acceleration are the exact
    derivatives of the position, and linear in the states: none of the three contains the noise w
    directly.

    A: System matrix, s^-1, shape (states, states). It consists of 2 x 2 blocks on the diagonal, one
        per resonance; each block is [[-d, w], [-w, -d]].
    B: Input, shape (states,). The stationary variance of a state is near 1.
    position, velocity, acceleration: rows that give the motion from the states, in m, m/s and
        m/s^2, shape (states,) each.
    error: the integral over the frequency (Hz) of r - log r - 1, in s^-1, where r is (given density
        + floor) / (this filter's density + floor): zero for a perfect fit. For white noise on the
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
    Raise `InputError` if the frequencies or densities make no spectrum, the floor is not above
    zero, or a filter of so many states does not exist or is badly conditioned.

    frequency: Frequencies in Hz, above zero and increasing, shape (m,). They should reach well
        beyond the band of the motion, and be closer to each other than the width of the spectrum's
        peak.
    density: Density at these frequencies, shape (m,), of any scale. It may be zero outside a band.
    states: Number of states, even.
    floor: Density that the sensors' noise has as a position, divided by the variance of the motion,
        Hz^-1: a number or an array of shape (m,). The fit is close where the density is above it.
    """
    from scipy.optimize import least_squares

    frequency, density = np.asarray(frequency, float), np.asarray(density, float)
    floor = np.broadcast_to(np.asarray(floor, float), frequency.shape)
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

    fits = [
        least_squares(
            residuals, start, slopes, bounds=sections.bounds(), x_scale="jac", max_nfev=EVALUATIONS
        )
        for start in sections.list_starts(density, floor)
    ]
    best = min(fits, key=lambda fit: float(fit.cost))
    return _realise(*sections.roots(best.x), frequency, target, floor)


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
