"""The test inputs (probes) on which a chain is run instead of records.

The mean over records of a sum of squared errors equals a sum over any orthonormal basis of the
inputs. In the bases used here the squared error changes smoothly with the number of the basis
vector, so a few dozen of them are run and the others are interpolated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.contract import Sensors


@dataclass(frozen=True)
class Probe:
    """Sinusoids of different frequencies that enter a chain in the same way.

    Attributes
    ----------
    angle
        (n,) phase advance per step of the IMU, rad.
    force, fix
        (n,) amplitude in the IMU's samples, and in the fixes, of a unit sinusoid.
    truth
        Whether the sinusoid is a displacement that the estimate should follow; its fixes arrive
        with their delay. If not, the estimate should stay at zero.
    phasor
        Whether both a cosine and a sine are run for each sinusoid. If not, only the sine is run,
        with the phase `shift`.
    shift
        Phase at step 0, rad.
    """

    angle: Array
    force: Array
    fix: Array
    truth: bool = False
    phasor: bool = True
    shift: float = 0.0

    def part(self, first: int, last: int) -> Probe:
        """A probe with the sinusoids `first` to `last` - 1."""
        some = slice(first, last)
        return replace(self, angle=self.angle[some], force=self.force[some], fix=self.fix[some])


def motion(frequency: Array, sensors: Sensors) -> Probe:
    """Displacements e^{iwt} of 1 m at frequencies in Hz."""
    omega = 2.0 * np.pi * frequency
    return Probe(omega * sensors.step, -(omega**2), np.ones(len(omega)), truth=True)


def forces(number: Array, steps: int) -> Probe:
    """Specific forces e^{2 pi i number k / steps}; times 1/sqrt(steps), a basis of IMU noise."""
    return Probe(2.0 * np.pi * number / steps, np.ones(len(number)), np.zeros(len(number)))


def fixes(number: Array, count: int, sensors: Sensors) -> Probe:
    """Fixes e^{2 pi i number q / count}; times 1/sqrt(count), a basis of the noise of fixes."""
    angle = 2.0 * np.pi * number / (count * sensors.fix_interval)
    return Probe(angle, np.zeros(len(number)), np.ones(len(number)))


def walks(number: Array, steps: int) -> Probe:
    """The eigenvectors of a Wiener process that starts from zero at step 0: sin(angle k)."""
    angle = (2.0 * number - 1.0) * np.pi / (2.0 * (steps - 1) + 1.0)
    return Probe(angle, np.ones(len(number)), np.zeros(len(number)), phasor=False)


def constant() -> Probe:
    """A constant force of 1 m/s^2, written as sin(0 k + pi/2)."""
    return Probe(np.zeros(1), np.ones(1), np.zeros(1), phasor=False, shift=0.5 * np.pi)
