"""A sea state (JONSWAP): realisations with random phases, their kinematics, loads on a cylinder.

Kinematics are linear, and waves travel in one direction. Heights are in m above the still water
line. Loads are per metre of a fixed vertical cylinder (Morison et al. 1950). Their
inertia term is MacCamy and Fuchs' (1954), in which waves that are short beside the cylinder are
diffracted: its coefficient is complex and 2 for long waves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.gravity import GRAVITY

#: Raised when a number that this room computes changes.
NUMERICS_VERSION = 0
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
    """A sea state: significant wave height (m), peak period (s), JONSWAP's gamma."""

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

    def steepness(self) -> float:
        """Compute H_s over the length of a deep-water wave of the period T_p."""
        return self.hs / (GRAVITY * self.tp**2 / (2.0 * np.pi))

    @property
    def breaks(self) -> bool:
        """Whether the sea is steeper than waves can be (`STEEPEST`)."""
        return self.steepness() > STEEPEST

    @property
    def is_found(self) -> bool:
        """Whether sea states as steep as this one are found (`STEEPEST_SEAS`).

        That is about half as steep as `breaks`: a sea loses its height in its largest waves.
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

    `numbers`, `elevation`: numbers of the lines, and their complex amplitudes in m, shape (lines,)
    each. `period`: time in s after which the waves repeat. `depth`, `gravity`: water depth in m,
    and acceleration of gravity in m/s^2.
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
        """Compute the complex amplitudes of the acceleration, m/s^2, as `velocity` does in m/s."""
        return np.asarray(1j * self.omega * self.velocity(height))


def find_wave_number(omega: Array, depth: float, gravity: float = GRAVITY) -> Array:
    """Solve the dispersion relation omega^2 = g k tanh k d of linear waves for k, rad/m.

    `omega` is in rad/s, above 0; `depth` in m. Newton's method on x tanh x, x = k d, which begins
    at the larger of the limits for deep and shallow water.
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
    height of every realisation is that of the spectrum in the band. In every sea, line m takes the
    random number of index m of `phase`. `period` is in s, `depth` in m. Raise `InputError` if the
    period is so short that no line lies in the band.
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


@dataclass(frozen=True)
class Cylinder:
    """A vertical cylinder: diameter (m), density of the water (kg/m^3), Morison's drag C_D."""

    diameter: float
    density: float = 1025.0
    drag: float = 1.0


def inertia_coefficient(wave_number: Array, diameter: float) -> NDArray[np.complex128]:
    """Compute the complex inertia coefficient C_M of a cylinder in waves, by MacCamy and Fuchs.

    The force per length is C_M rho pi D^2/4 times the complex amplitude of the undisturbed water's
    acceleration at the cylinder's axis, with time as exp(i omega t): C_M = -4 i / (pi (k a)^2
    H_1^(2)'(k a)), a = D/2. C_M is 2 for k a -> 0. Wave numbers are in rad/m, above 0, shape
    (lines,); the diameter D is in m.
    """
    from scipy.special import h2vp

    x = np.asarray(wave_number) * diameter / 2.0
    return np.asarray(-4j / (np.pi * x**2 * h2vp(1, x)))


def inertia_force(waves: Waves, cylinder: Cylinder, height: float) -> NDArray[np.complex128]:
    """Compute the complex amplitudes of the inertia force per length, N/m, shape (lines,).

    `height` is in m, between the sea bed and 0.
    """
    mass = cylinder.density * np.pi / 4.0 * cylinder.diameter**2
    coefficient = inertia_coefficient(waves.wave_number, cylinder.diameter)
    return np.asarray(mass * coefficient * waves.acceleration(height))


def drag_force(velocity: Array, cylinder: Cylinder) -> Array:
    """Compute the drag per length, N/m, on a cylinder at rest; `velocity` of the water, m/s."""
    factor = 0.5 * cylinder.density * cylinder.drag * cylinder.diameter
    return np.asarray(factor * velocity * np.abs(velocity))
