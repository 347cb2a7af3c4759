"""Computes a scheme's settled error per unit of motion, over the frequency of the motion.

A chain is a scheme's form for the batch engine. Once its gains have settled, it is a linear system
whose coefficients repeat with the fixes. Its response to a unit motion e^{iwt} is h_k e^{iwt_k},
where h_k repeats as the chain does. For a sinusoid of random phase the mean square error is the
mean of |h_k - 1|^2 over one period times the sinusoid's mean square. The mean square errors of
sinusoids with different frequencies and independent phases add.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.settled import KEPT_CYCLES, cycle_of, limit, longest, settled

Complex = NDArray[np.complex128]

#: Sinusoids run at once: the inputs of 16 over 1000 s at 100 Hz take 26 MB.
BATCH = 16
#: Largest part of |h_k - 1| that the transient may still make up, relative.
TOLERANCE = 1e-5
#: Number of frequencies over a band at which an error spectrum is integrated.
QUADRATURE = 20_000


@dataclass(frozen=True)
class ErrorSpectrum:
    """Settled mean square error divided by the mean square of a sinusoidal motion.

    Attributes
    ----------
    frequency
        (n,) Hz, increasing.
    position
        (n,) m^2 per m^2 of displacement, of the position x + y.
    velocity
        (n,) s^-2: (m/s)^2 per m^2 of displacement, of the velocity vx + vy.
    """

    frequency: Array
    position: Array
    velocity: Array

    def of(self, measure: str) -> Array:
        """The values of one measure; `measure` is `position` or `velocity`."""
        return {"position": self.position, "velocity": self.velocity}[measure]


def error_spectrum(
    chain: Chain, sensors: Sensors, frequencies: Array, *, settle: float = 100.0
) -> ErrorSpectrum:
    """The error spectrum of a chain: its error from motion, without noise.

    A displacement along any direction d gives d * h on the two axes, so x + y is the error along d.

    Parameters
    ----------
    frequencies
        (n,) Hz, increasing. None may be a multiple of the rate at which the chain repeats: to the
        GNSS such a motion looks like a standstill.
    settle
        Time (s) before the response is first examined. The transient that is left then is removed
        by extrapolation (`settled.limit`). The time is doubled until the remainder is less than
        `TOLERANCE` of the error.

    Raises
    ------
    InputError
        If a frequency is not positive or repeats with the chain, or the response does not settle.
    """
    frequency = np.asarray(frequencies, dtype=float)
    if frequency.ndim != 1 or not np.all(frequency > 0.0) or np.any(np.diff(frequency) <= 0.0):
        raise InputError("frequencies: give a list of positive frequencies in Hz, increasing")
    steady = settled(chain)
    cycles = frequency * cycle_of(steady) * sensors.step
    if np.any(np.abs(cycles - np.round(cycles)) < 1e-3):
        bad = frequency[np.argmin(np.abs(cycles - np.round(cycles)))]
        raise InputError(
            f"frequencies: {bad:g} Hz is a multiple of the rate at which the scheme repeats, so "
            "that its fixes look constant; leave it out"
        )
    parts = [
        _batch(steady, sensors, frequency[first : first + BATCH], settle)
        for first in range(0, len(frequency), BATCH)
    ]
    position, velocity = (np.concatenate(part) for part in zip(*parts, strict=True))
    return ErrorSpectrum(frequency, position, velocity)


def _batch(chain: Chain, sensors: Sensors, frequency: Array, settle: float) -> tuple[Array, Array]:
    """Mean over a cycle of |h - 1|^2 and of |h_v - iw|^2, (n,) each."""
    cycle = cycle_of(chain)
    steps = max(round(settle / sensors.step / cycle), 1) * cycle
    most = longest(chain)
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
    """h - 1 and h_v - iw over the last cycles, (cycles, steps of a cycle, n) each."""
    cycle = cycle_of(chain)
    total = steps + KEPT_CYCLES * cycle
    omega = 2.0 * np.pi * frequency
    wave = np.exp(1j * omega * (sensors.step * np.arange(total)[:, None]))
    fix_steps = np.arange(0, total, sensors.fix_interval)[:, None] - sensors.delay
    fixes = np.exp(1j * omega * (sensors.step * fix_steps))
    force = _lanes(-(omega**2) * wave)

    answer = np.empty((2, total - steps, len(frequency)), dtype=complex)
    for k0, n, memory in batch.chunks(chain, force, _lanes(fixes)):
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
    """One lane for the cosine and one for the sine of each frequency: (steps, [n cos | n sin])."""
    return np.ascontiguousarray(np.hstack([values.real, values.imag]))


def expected_mse(
    errors: ErrorSpectrum,
    density: Callable[[Array], Array],
    band: tuple[float, float],
    *,
    rms: float = 1.0,
) -> tuple[float, float]:
    """The settled MSE of position and velocity that a random motion of a given spectrum causes.

    Parameters
    ----------
    errors
        An error spectrum that covers the band.
    density
        S(f) at frequencies in Hz, in any unit.
    band
        Lowest and highest frequency of the motion, Hz.
    rms
        Root mean square displacement, m.

    Returns
    -------
    tuple of float
        Position (m^2) and velocity ((m/s)^2), x + y: rms^2 times the mean of the error spectrum
        weighted by S. The noise floor has to be added.

    Raises
    ------
    InputError
        If the error spectrum does not cover the band.
    """
    low, high = band
    nodes = errors.frequency
    if low < nodes[0] * (1.0 - 1e-9) or high > nodes[-1] * (1.0 + 1e-9):
        raise InputError(
            f"band: [{low:g}, {high:g}] Hz is wider than the error spectrum, which reaches from "
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
