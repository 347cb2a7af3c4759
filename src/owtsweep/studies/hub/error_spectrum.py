"""Computes a scheme's error spectrum: the settled error per unit of motion at each frequency.

Once its gains have settled, a chain is a linear system whose coefficients repeat with the position
fixes. Its response to a unit motion e^{iwt} is h_k e^{iwt_k}, where h_k repeats as the coefficients
do. For a sinusoid of random phase, the mean square error is the mean of |h_k - 1|^2 over one
repetition times the sinusoid's mean square. Mean square errors of sinusoids with different
frequencies and independent phases add.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.sensors import Sensors, force_per_displacement
from owtsweep.studies.hub.settled import KEPT_CYCLES, MOST_CYCLES, cycle_of, limit, settled

Complex = NDArray[np.complex128]

#: Number of sinusoids run at once: the inputs of 16 sinusoids over 1000 s at 100 Hz take 26 MB.
BATCH = 16
#: Largest relative part of |h_k - 1| that may still be due to the transient.
TOLERANCE = 1e-5
#: Number of frequencies in a band at which an error spectrum is integrated.
QUADRATURE = 20_000


@dataclass(frozen=True)
class ErrorSpectrum:
    """The settled mean square error due to a sinusoidal motion, per mean square displacement.

    frequency: of the motion, Hz, increasing, shape (n,).
    position: sum over x and y, m^2/m^2, shape (n,).
    velocity: sum over vx and vy, s^-2, shape (n,).
    """

    frequency: Array
    position: Array
    velocity: Array

    def of(self, measure: str) -> Array:
        """Return the spectrum of one measure, "position" or "velocity", shape (n,)."""
        return {"position": self.position, "velocity": self.velocity}[measure]


def error_spectrum(
    chain: Chain, sensors: Sensors, frequencies: Array, *, settle: float = 100.0
) -> ErrorSpectrum:
    """Compute the error spectrum of a chain: the settled error due to motion, without noise.

    Both axes respond alike. So the sum of the mean square errors of x and y is the mean square
    error along the motion, whatever the direction.

    frequencies: of the motion, Hz, increasing, shape (n,). None may be a multiple of the rate at
        which the chain repeats: to the GNSS such a motion is a standstill.
    settle: time (s) after which the response is first examined. The transient that is left then is
        removed by extrapolation (`settled.limit`). The time is doubled until the extrapolation is
        uncertain by at most the part `TOLERANCE` of the error.
    Raises InputError if frequencies are not positive and increasing, if one is such a multiple, or
    if the response does not settle.
    """
    frequency = np.asarray(frequencies, dtype=float)
    if frequency.ndim != 1 or not np.all(frequency > 0.0) or np.any(np.diff(frequency) <= 0.0):
        raise InputError("frequencies: give a list of positive frequencies in Hz, increasing")
    steady = settled(chain)
    cycles = frequency * cycle_of(steady) * sensors.step
    if np.any(look_constant(cycles)):
        bad = frequency[np.argmin(np.abs(cycles - np.round(cycles)))]
        raise InputError(
            f"frequencies: {bad:g} Hz is a multiple of the rate at which the scheme repeats, so "
            "that the position fixes would look constant; leave this frequency out"
        )
    parts = [
        _batch(steady, sensors, frequency[first : first + BATCH], settle)
        for first in range(0, len(frequency), BATCH)
    ]
    position, velocity = (np.concatenate(part) for part in zip(*parts, strict=True))
    return ErrorSpectrum(frequency, position, velocity)


def look_constant(cycles: Array) -> NDArray[np.bool_]:
    """Say which sinusoids are constant to a sensor that repeats its measurement.

    `cycles` says how many periods of each sinusoid pass between two measurements, shape (n,).
    """
    return np.asarray(np.abs(cycles - np.round(cycles)) < 1e-3)


def _batch(chain: Chain, sensors: Sensors, frequency: Array, settle: float) -> tuple[Array, Array]:
    """Compute the error spectrum at n frequencies (Hz): position and velocity, shape (n,) each.

    The chain's gains are settled; `settle` is as in `error_spectrum`. Raises InputError if the
    response does not settle within the longest run.
    """
    cycle = cycle_of(chain)
    steps = max(round(settle / sensors.step / cycle), 1) * cycle
    most = MOST_CYCLES * cycle
    while True:
        error = _error_phasors(chain, sensors, frequency, steps)
        (position, rest_p), (velocity, rest_v) = (limit(part) for part in error)
        if max(rest_p.max(), rest_v.max()) <= TOLERANCE:
            return np.mean(np.abs(position) ** 2, axis=0), np.mean(np.abs(velocity) ** 2, axis=0)
        if steps >= most:
            raise InputError(
                f"settle: the response to a sinusoid has not settled after "
                f"{steps * sensors.step:.0f} s with this tuning; give the bias a larger q_b"
            )
        steps = min(2 * steps, most)


def _error_phasors(
    chain: Chain, sensors: Sensors, frequency: Array, steps: int
) -> tuple[Complex, Complex]:
    """Compute the complex errors of position and velocity in the last cycles of a run.

    The run has `steps` steps, and then the last `KEPT_CYCLES` cycles, after each of which the chain
    repeats. The motion is e^{iwt}, at n frequencies (Hz); errors are divided by e^{iwt}. Each of
    the two results has the shape (cycles, steps of a cycle, n).
    """
    cycle = cycle_of(chain)
    total = steps + KEPT_CYCLES * cycle
    omega = 2.0 * np.pi * frequency
    wave = np.exp(1j * omega * (sensors.step * np.arange(total)[:, None]))
    fix_steps = np.arange(0, total, sensors.fix_interval)[:, None] - sensors.delay
    fixes = np.exp(1j * omega * (sensors.step * fix_steps))
    force = _lanes(force_per_displacement(omega, sensors) * wave)

    answer = np.empty((2, total - steps, len(frequency)), dtype=complex)
    for k0, n, memory in estimates.chunks(chain, force, _lanes(sensors.fix_scale * fixes)):
        skip = max(steps - k0, 0)
        if skip >= n:
            continue
        for out, source in zip(answer, (memory.position, memory.velocity), strict=True):
            real, imaginary = np.split(source[skip:n], 2, axis=1)
            out[k0 + skip - steps : k0 + n - steps] = real + 1j * imaginary
    answer /= wave[steps:]
    answer[0] -= 1.0
    answer[1] -= 1j * omega
    cycles = answer.reshape(2, KEPT_CYCLES, cycle, len(frequency))
    return cycles[0], cycles[1]


def _lanes(values: Complex) -> Array:
    """Split complex values (steps, n) into real values (steps, 2 n): real, then imaginary parts."""
    return np.ascontiguousarray(np.hstack([values.real, values.imag]))


def expected_mse(
    errors: ErrorSpectrum,
    density: Callable[[Array], Array],
    band: tuple[float, float],
    *,
    rms: float = 1.0,
) -> tuple[float, float]:
    """Compute the settled MSE that a random motion with a given spectrum causes, without noise.

    The results are position (m^2) and velocity ((m/s)^2), sums over both axes: rms^2 times the mean
    of the error spectrum weighted by S.

    density: function that returns the spectral density S(f) at frequencies in Hz, in any unit.
    band: lowest and highest frequency of the motion, Hz.
    rms: root mean square displacement, m.
    Raises InputError if the error spectrum does not cover the band.
    """
    low, high = band
    nodes = errors.frequency
    if low < nodes[0] * (1.0 - 1e-9) or high > nodes[-1] * (1.0 + 1e-9):
        raise InputError(
            f"band: [{low:g}, {high:g}] Hz reaches beyond the error spectrum, which is known from "
            f"{nodes[0]:g} to {nodes[-1]:g} Hz"
        )
    f = np.linspace(low, high, QUADRATURE)
    weight = density(f)
    weight = weight / np.sum(weight)
    # logarithmic, because between two nodes an error spectrum is closer to a power law than to a
    # straight line
    position, velocity = (
        float(rms**2 * np.sum(weight * np.exp(np.interp(np.log(f), np.log(nodes), np.log(values)))))
        for values in (errors.position, errors.velocity)
    )
    return position, velocity
