"""The test inputs (probes) on which a scheme is run instead of records.

The mean over records of a sum of squared errors equals a sum over any orthonormal basis of the
inputs. In the bases used here the squared error changes smoothly with the number of the basis
vector. So a scheme is run on a few dozen basis vectors, and the errors for the other vectors are
interpolated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.sensors import Sensors, force_per_displacement


@dataclass(frozen=True)
class Probe:
    """A test input: n sinusoids of different frequencies that enter a scheme in the same way.

    angle: phase advance per step of the IMU, rad, shape (n,).
    force, fix: amplitudes that a unit sinusoid has in the IMU's samples and in the position fixes,
        shape (n,) each.
    truth: true if the sinusoid is a displacement that the estimate should follow; fixes then arrive
        with the delay of the GNSS. False if the estimate should stay at zero.
    phasor: true if both a cosine and a sine are run for each sinusoid, false if only the sine is
        run.
    shift: phase at step 0, rad.
    """

    angle: Array
    force: Array
    fix: Array
    truth: bool = False
    phasor: bool = True
    shift: float = 0.0

    def part(self, first: int, last: int) -> Probe:
        """Return a test input with the sinusoids number `first` ... last - 1."""
        some = slice(first, last)
        return replace(self, angle=self.angle[some], force=self.force[some], fix=self.fix[some])


def motion(frequency: Array, sensors: Sensors) -> Probe:
    """Make a probe of sinusoidal displacements of 1 m at frequencies in Hz, shape (n,)."""
    omega = 2.0 * np.pi * frequency
    force = force_per_displacement(omega, sensors).real  # checks.py refuses an AC coupling
    fix = np.full(len(omega), sensors.fix_scale)
    return Probe(omega * sensors.step, force, fix, truth=True)


def forces(number: Array, steps: int) -> Probe:
    """Make a probe of specific forces e^{2 pi i number k / steps} at steps k = 0 ... steps - 1.

    Divided by sqrt(steps), the vectors are an orthonormal basis of IMU noise; `number` is (n,).
    """
    return Probe(2.0 * np.pi * number / steps, np.ones(len(number)), np.zeros(len(number)))


def fixes(number: Array, count: int, sensors: Sensors) -> Probe:
    """Make a probe of position fixes e^{2 pi i number q / count}, fix number q = 0 ... count - 1.

    Divided by sqrt(count), the vectors are an orthonormal basis of their noise; `number` is (n,).
    """
    angle = 2.0 * np.pi * number / (count * sensors.fix_interval)
    return Probe(angle, np.zeros(len(number)), np.ones(len(number)))


def walks(number: Array, steps: int) -> Probe:
    """Make a probe of the eigenvectors of a Wiener process: forces sin(angle k) at steps k.

    The process starts from zero at step 0. `number`, shape (n,), counts eigenvectors from 1 on.
    """
    angle = (2.0 * number - 1.0) * np.pi / (2.0 * (steps - 1) + 1.0)
    return Probe(angle, np.ones(len(number)), np.zeros(len(number)), phasor=False)


def constant() -> Probe:
    """Make a probe of a constant specific force of 1 m/s^2, as sin(0 k + pi/2) at steps k."""
    return Probe(np.zeros(1), np.ones(1), np.zeros(1), phasor=False, shift=0.5 * np.pi)
