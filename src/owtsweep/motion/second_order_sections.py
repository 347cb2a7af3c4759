"""Computes spectral densities of rational filters from the roots of their second-order sections.

A section is (s + d)^2 + w^2, which has the roots -d + i w and -d - i w. The denominator of a filter
is a product of sections. The numerator is a product of two sections less, times s + c with a real
c. So the filter has three poles more than zeros.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Least decay d of zeros, s^-1; zeros without decay take the density to zero at their frequency.
LEAST_DECAY = 1e-5


@dataclass(frozen=True)
class Sections:
    """The densities of the filters of one order at given frequencies, over their free numbers.

    The free numbers of a filter are log w and log d of each section, those of the poles first, and
    log c at the end; shape (2 states - 3,). All of w, d and c are in s^-1.

    Attributes
    ----------
    frequency
        Frequencies in Hz, increasing, shape (m,).
    width
        Width of the interval that each frequency stands for in integrals, Hz, shape (m,).
    states
        Number of poles: even, four or more.
    """

    frequency: Array
    width: Array
    states: int

    @property
    def poles(self) -> int:
        """The number of sections of the denominator; the numerator has two less."""
        return self.states // 2

    def bounds(self) -> tuple[Array, Array]:
        """Return the least and the greatest values of the free numbers.

        Resonances are wide enough for the frequencies to show them.
        """
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
        """Compute the derivatives of the density by the free numbers, shape (free numbers, m).

        `density` is what the method of this name returns for the free numbers.
        """
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

        `density` is what is searched for and `floor` what hides the rest of it, shape (m,) each. A
        resonance stands at the density's peak. The others are spread over the band in which the
        density is not far below the floor, with zeros at the band's edges and between the poles.
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
