"""A sea state (JONSWAP), realisations of it with random phases, and their linear kinematics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.gravity import GRAVITY

#: Frequencies (Hz) between which waves have lines. Above the upper edge the spectrum of a sea with
#: a peak period of 3 s or more is below a hundredth of its peak.
BAND = (0.02, 1.0)
#: Steepness H_s / (g T_p^2 / 2 pi) above which a sea breaks (DNV-RP-C205, section 3.5.4: 1/7).
STEEPEST = 1.0 / 7.0
#: Peak periods (s), and the largest of these steepnesses that sea states have there; between the
#: periods it is interpolated (DNV-RP-C205, steepness criteria of sea states; API RP 2MET: 1/16 to
#: 1/20 in severe seas). Steeper seas lose their height by breaking.
STEEPEST_SEAS = (8.0, 15.0), (1.0 / 15.0, 1.0 / 25.0)
#: Most steps of Newton's method for the dispersion relation, and the change at which it ends.
NEWTON_STEPS, NEWTON_CHANGE = 50, 1e-14


@dataclass(frozen=True)
class Sea:
    """A sea state.

    Attributes
    ----------
    hs
        Significant wave height, m.
    tp
        Period of the spectrum's peak, s.
    gamma
        Peak enhancement factor of the JONSWAP spectrum.
    """

    hs: float
    tp: float
    gamma: float = 3.3

    def __post_init__(self) -> None:
        require(self.hs > 0.0, f"hs: {self.hs:g} m must be above 0")
        low, high = 1.0 / BAND[1], 1.0 / BAND[0]
        require(
            3.0 * low <= self.tp <= 0.5 * high,
            f"tp: {self.tp:g} s must be {3.0 * low:g} to {0.5 * high:g} s, because waves have "
            f"lines from {BAND[0]:g} to {BAND[1]:g} Hz",
        )
        require(self.gamma >= 1.0, f"gamma: {self.gamma:g} must be 1 or more")

    def steepness(self, gravity: float = GRAVITY) -> float:
        """Compute H_s over the length of a deep-water wave of the period T_p."""
        return self.hs / (gravity * self.tp**2 / (2.0 * np.pi))

    @property
    def breaks(self) -> bool:
        """Whether the sea is steeper than waves can be (`STEEPEST`)."""
        return self.steepness() > STEEPEST

    @property
    def is_found(self) -> bool:
        """Whether sea states as steep as this one are found (`STEEPEST_SEAS`).

        The limit is about half of that at which a single wave breaks (`breaks`), because a sea
        loses its height in its largest waves.
        """
        return bool(self.steepness() <= np.interp(self.tp, *STEEPEST_SEAS))

    def density(self, frequency: Array) -> Array:
        """Compute the spectral density of the surface elevation, m^2/Hz, at frequencies in Hz."""
        from waveresponse import JONSWAP

        _, density = JONSWAP(frequency, freq_hz=True)(self.hs, self.tp, self.gamma)
        return np.asarray(density)


@dataclass(frozen=True)
class Waves:
    """A realisation of a sea: lines with amplitudes, phases and wave numbers.

    The elevation at the structure is Re sum_m elevation[m] exp(2 pi i f_m t), f_m = numbers[m] /
    period.

    Attributes
    ----------
    numbers
        Numbers of the lines, shape (lines,).
    period
        Time in s after which the waves repeat.
    elevation
        Complex amplitudes in m, shape (lines,).
    depth, gravity
        Water depth in m, and acceleration of gravity in m/s^2.
    """

    numbers: NDArray[np.int64]
    period: float
    elevation: NDArray[np.complex128]
    depth: float
    gravity: float = GRAVITY

    @property
    def omega(self) -> Array:
        """Angular frequencies in rad/s, shape (lines,)."""
        return np.asarray(2.0 * np.pi * self.numbers / self.period)

    @cached_property
    def wave_number(self) -> Array:
        """Wave numbers in rad/m, shape (lines,)."""
        return find_wave_number(self.omega, self.depth, self.gravity)

    def velocity(self, height: float) -> NDArray[np.complex128]:
        """Compute the complex amplitudes of the water's horizontal velocity, m/s, shape (lines,).

        Linear (Airy) waves up to the still water line: omega cosh k (z + d) / sinh k d times the
        elevation. `height` is z in m, -depth to 0.
        """
        k, d = self.wave_number, self.depth
        # cosh k (z + d) / sinh k d, without overflow in deep water
        ratio = (np.exp(k * height) + np.exp(-k * (height + 2.0 * d))) / (
            1.0 - np.exp(-2.0 * k * d)
        )
        return np.asarray(self.omega * ratio * self.elevation)

    def acceleration(self, height: float) -> NDArray[np.complex128]:
        """Compute the complex amplitudes of the water's horizontal acceleration, m/s^2.

        The shape is (lines,); `height` is in m, -depth to 0.
        """
        return np.asarray(1j * self.omega * self.velocity(height))


def find_wave_number(omega: Array, depth: float, gravity: float = GRAVITY) -> Array:
    """Solve the dispersion relation omega^2 = g k tanh k d of linear waves for k, rad/m.

    `omega` is in rad/s, above 0, any shape; `depth` in m; `gravity` in m/s^2. Newton's method on
    x tanh x, x = k d, which begins at the larger of the limits for deep and shallow water.
    """
    target = np.asarray(omega) ** 2 * depth / gravity
    x = np.maximum(target, np.sqrt(target))
    for _ in range(NEWTON_STEPS):
        tanh = np.tanh(x)
        change = (x * tanh - target) / (tanh + x * (1.0 - tanh**2))
        x = x - change
        if np.all(np.abs(change) <= NEWTON_CHANGE * x):
            break
    return np.asarray(x / depth)


def draw_waves(
    sea: Sea, phase: np.random.Generator, *, period: float, depth: float, gravity: float = GRAVITY
) -> Waves:
    """Draw a realisation of a sea: deterministic amplitudes, uniform random phases.

    Lines are at m / period inside `BAND`, with the amplitude sqrt(2 S df); so the significant wave
    height of every realisation is that of the spectrum in the band.

    Parameters
    ----------
    sea
        The sea state.
    phase
        Random generator of the phases. Line m takes the random number of index m, in every sea.
    period
        Time in s after which the waves repeat.
    depth, gravity
        Water depth in m, and acceleration of gravity in m/s^2.

    Raises
    ------
    InputError
        If the period is so short that no line lies in the band.
    """
    numbers = np.arange(
        int(np.ceil(BAND[0] * period - 1e-9)), int(np.floor(BAND[1] * period + 1e-9)) + 1
    )
    if len(numbers) < 2:
        raise InputError(
            f"record.duration: {period / 2.0:g} s are too short for waves; give at least "
            f"{2.0 / BAND[1]:g} s"
        )
    amplitude = np.sqrt(2.0 * sea.density(numbers / period) / period)
    phases = 2.0 * np.pi * phase.random(numbers[-1] + 1)[numbers]
    return Waves(numbers, period, amplitude * np.exp(1j * phases), depth, gravity)
