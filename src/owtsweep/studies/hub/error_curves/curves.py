"""Computes a scheme's expected errors, due to motion and to each noise, for records of one length.

Gains, initial states and windows are those of a simulated record, so the expectation holds whether
or not the scheme settles within the record. There are two approximations. Curves
(errors at each frequency) are interpolated between some frequencies, the nodes. A response that has
become periodic is assumed to stay periodic.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.error_curves import inputs, nodes
from owtsweep.studies.hub.error_curves.inputs import Probe
from owtsweep.studies.hub.error_curves.probing import Workspace
from owtsweep.studies.hub.sensors import Sensors, fix_count

#: An interval between two nodes is halved if interpolation at its middle is wrong by more than
#: this: relative to the curve (for motion), or to the whole sum (for noise).
MOTION_TOLERANCE = 2e-3
NOISE_TOLERANCE = 1e-4
#: The errors due to a bias' random walk are computed up to this frequency, in units of the fix
#: rate. Higher frequencies have at most 1e-4 of the walk's energy.
WALK_TO = 1.0


@dataclass(frozen=True)
class Curves:
    """The expected errors of one scheme for records of one length.

    Axes of length 2 are measure (position, velocity) and window (full, settled). Of two units, the
    first is for position and the second for velocity.

    frequency: Hz, shape (n,).
    motion: mean square error due to a sinusoidal displacement of random phase, divided by the
        displacement's mean square, along the direction of motion; m^2 per m^2 and s^-2; shape
        (2, 2, n).
    noise: error variance of one axis due to GNSS noise, IMU noise and the random walk of the IMU's
        bias; m^2 and (m/s)^2; shape (3, 2, 2).
    constant: mean square error of one axis due to a constant specific force, divided by the square
        of the force; s^4 and s^2; shape (2, 2).
    """

    frequency: Array
    motion: Array
    noise: Array
    constant: Array

    def at(self, frequency: Array) -> Array:
        """Interpolate `motion` at m frequencies (Hz) inside its band; shape (2, 2, m)."""
        return nodes.between(frequency, self.frequency, self.motion)


def curves(
    chain: Chain, sensors: Sensors, *, steps: int, settled: int, band: Sequence[float]
) -> Curves:
    """Compute the expected errors of a chain by running it on test inputs.

    chain: made for records of `steps` steps.
    settled: the first step of the settled window.
    band: lowest and highest frequency of the motion, Hz.
    """
    prober = _Prober(chain, sensors, steps, settled)
    motion = prober.motion(band)
    lengths = np.array([steps, steps - settled])
    noise = [
        sensors.position_sigma**2 * prober.fixes(),
        sensors.force_sigma**2 * prober.forces(),
        sensors.bias_walk**2 * sensors.step * prober.walks(),
    ]
    return Curves(
        frequency=motion[0],
        motion=motion[1] / lengths[:, None],
        noise=np.array(noise) / lengths,
        constant=prober.energies(inputs.constant())[..., 0] / lengths,
    )


class _Prober:
    """Runs a chain on test inputs as long as a record.

    Sums of squared errors have the shape (2, 2): measure, window.
    """

    def __init__(self, chain: Chain, sensors: Sensors, steps: int, settled: int) -> None:
        self.sensors, self.steps = sensors, steps
        self.scales = nodes.scales(chain, sensors)
        self.energies = Workspace(chain, sensors, steps, settled).energies

    def motion(self, band: Sequence[float]) -> tuple[Array, Array]:
        """Sum the squared errors due to sinusoidal motion at n frequencies in a band (Hz).

        Return the frequencies, chosen so that interpolation between them is accurate, and the sums,
        shape (2, 2, n).
        """

        def large(left: Array, right: Array, part: Array, values: Array) -> Array:
            return np.asarray(np.any(part > MOTION_TOLERANCE * values, axis=(0, 1)))

        def answer(frequency: Array) -> Array:
            return self.energies(inputs.motion(frequency, self.sensors))

        first = nodes.over_band(band, self.scales, self.steps * self.sensors.step)
        return nodes.refined(first, answer(first), answer, large)

    def fixes(self) -> Array:
        """Sum the squared errors due to noise of variance 1 m^2 in the position fixes."""
        count = fix_count(self.steps, self.sensors.fix_interval)
        per_number = 1.0 / (count * self.sensors.fix_step)
        return self._phasors(count, per_number, lambda n: inputs.fixes(n, count, self.sensors))

    def forces(self) -> Array:
        """Sum the squared errors due to white noise of variance 1 (m/s^2)^2 in IMU samples."""
        per_number = 1.0 / (self.steps * self.sensors.step)
        return self._phasors(self.steps, per_number, lambda n: inputs.forces(n, self.steps))

    def _phasors(self, count: int, per_number: float, probe: Callable[[Array], Probe]) -> Array:
        """Sum squared errors over a basis of `count` phasors, the test inputs `probe(number)`.

        A phasor is a cosine and a sine of one frequency: `per_number` (Hz) times the phasor's
        number. The phasors number n and count - n have equal errors.
        """
        number = np.arange(1.0, count // 2 + 1.0)
        weight = np.where(2.0 * number == count, 1.0, 2.0) / count
        constant = self.energies(probe(np.zeros(1)))[..., 0] / count
        return constant + self._sum(weight, per_number, probe)

    def walks(self) -> Array:
        """Sum squared errors due to a Wiener process of specific force, increments of variance 1.

        The covariance of steps k and l is min(k, l); its eigenvectors are sin(angle k), its
        eigenvalues 1 / (2 - 2 cos angle).
        """
        last = self.steps - 1
        per_number = 0.5 / (self.steps * self.sensors.step)
        highest = min(last, max(round(WALK_TO * self.scales.rate / per_number), 64))
        number = np.arange(1.0, highest + 1.0)
        angle = inputs.walks(number, self.steps).angle
        weight = 4.0 / (2.0 * last + 1.0) / (2.0 - 2.0 * np.cos(angle))
        return self._sum(weight, per_number, lambda n: inputs.walks(n, self.steps))

    def _sum(self, weight: Array, per_number: float, probe: Callable[[Array], Probe]) -> Array:
        """Sum weight x squared error over the basis vectors number 1 ... n, where n = len(weight).

        The chain is run on some basis vectors, the test inputs `probe(numbers)`; the squared errors
        of the others are interpolated. A basis vector's frequency is its number times `per_number`
        (Hz).
        """

        def answer(number: Array) -> Array:
            return self.energies(probe(number))

        number = np.arange(1.0, len(weight) + 1.0)
        first = nodes.numbers(len(weight), per_number, self.scales)
        upto = np.concatenate([[0.0], np.cumsum(weight)])
        values = answer(first)
        if len(first) < 2:
            return np.asarray(np.sum(weight * values, axis=-1))
        total = np.sum(weight * nodes.between(number, first, values), axis=-1)

        def large(left: Array, right: Array, part: Array, values: Array) -> Array:
            shares = upto[right.astype(int)] - upto[left.astype(int)]
            return np.asarray(
                np.any(part * shares > NOISE_TOLERANCE * total[..., None], axis=(0, 1))
            )

        curve = nodes.refined(first, values, answer, large, whole=True)
        return np.asarray(np.sum(weight * nodes.between(number, *curve), axis=-1))
