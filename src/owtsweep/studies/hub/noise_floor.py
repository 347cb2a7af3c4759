"""Computes the noise floor: the settled MSE that sensor noise alone causes, without sampling.

A settled chain repeats after each cycle of steps. So the variance of its error, averaged over a
cycle, follows from its responses to unit impulses, one at each step of one cycle. For noise of
variance 1, it is the energy of these responses (the sum of their squares) divided by the number of
steps in the cycle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.settled import cycle_of, filling, settled

SOURCES = ("gnss", "imu", "bias")
#: Largest uncertainty of the energy in a response's extrapolated tail, relative to all its energy.
TOLERANCE = 1e-3
#: Number of cycles for which the responses are computed, at first and at most.
FIRST_CYCLES = 64
MOST_CYCLES = 1024


@dataclass(frozen=True)
class NoiseFloor:
    """The settled MSE due to sensor noise alone, by source of the noise; sums over both axes.

    position, velocity: source -> MSE, m^2 and (m/s)^2. The sources are `gnss`
        (white noise of the fixes), `imu` (white noise of the IMU's samples) and `bias`
        (the walk of the IMU's bias). A constant bias causes no settled error.
    """

    position: dict[str, float]
    velocity: dict[str, float]

    def of(self, measure: str) -> float:
        """Return the MSE of one measure, "position" or "velocity", summed over all sources."""
        return sum({"position": self.position, "velocity": self.velocity}[measure].values())


def noise_floor(chain: Chain, sensors: Sensors) -> NoiseFloor:
    """Compute the noise floor of a chain, exact but for the extrapolated tails of its responses.

    Raises InputError if the responses to impulses do not die out within `MOST_CYCLES` cycles: the
    estimator is unstable, or the estimated bias settles too slowly.
    """
    steady = settled(chain)
    variance = {
        "gnss": sensors.position_sigma**2,
        "imu": sensors.force_sigma**2,
        "bias": sensors.bias_walk**2 * sensors.step,
    }
    cycles = FIRST_CYCLES
    while True:
        energies = _energies(steady, sensors, cycles)
        sums = {
            key: _total(energy) if variance[key[0]] > 0.0 else (0.0, 0.0)
            for key, energy in energies.items()
        }
        if all(rest <= TOLERANCE * total for total, rest in sums.values()):
            break
        if cycles >= MOST_CYCLES:
            raise InputError(
                "chain: the response to noise has not died out after "
                f"{cycles * cycle_of(steady) * sensors.step:.0f} s with this tuning, so there is "
                "no settled noise floor; give the bias a larger q_b"
            )
        cycles *= 2
    axes_per_cycle = 2.0 / cycle_of(steady)
    position, velocity = (
        {source: axes_per_cycle * variance[source] * sums[source, out][0] for source in SOURCES}
        for out in ("position", "velocity")
    )
    return NoiseFloor(position, velocity)


def _energies(chain: Chain, sensors: Sensors, cycles: int) -> dict[tuple[str, str], Array]:
    """Compute the energies of a settled chain's responses to unit impulses.

    The impulses come in the first cycle, one at each of its steps or position fixes. The result is
    (source of noise, measure) -> energy in each of the cycles, shape (cycles,).
    """
    cycle, M = cycle_of(chain), sensors.fix_interval
    start = -(-filling(chain) // cycle) * cycle
    fixes_in_cycle = cycle // M
    steps = start + cycles * cycle
    force = np.zeros((steps, cycle + fixes_in_cycle))
    fixes = np.zeros((-(-steps // M), cycle + fixes_in_cycle))
    force[start : start + cycle, :cycle] = np.eye(cycle)
    fixes[start // M : start // M + fixes_in_cycle, cycle:] = np.eye(fixes_in_cycle)

    position, velocity, _ = estimates.trajectories(chain, force, fixes)
    result = {}
    for out, answer in (("position", position), ("velocity", velocity)):
        shaped = answer[start:].reshape(cycles, cycle, -1)
        force_response = shaped[:, :, :cycle]
        result["imu", out] = _per_cycle(force_response)
        result["gnss", out] = _per_cycle(shaped[:, :, cycle:])
        result["bias", out] = _per_cycle(_step_responses(force_response))
    return result


def _per_cycle(response: Array) -> Array:
    return np.asarray(np.sum(response**2, axis=(1, 2)))


def _step_responses(impulse: Array) -> Array:
    """Compute the responses to constant forces, each of which begins at a step of the first cycle.

    A change of the bias is such a force. A constant force is a sum of impulses, one at each step
    from its beginning on. The response to an impulse in a later cycle is the response to the same
    impulse in the first cycle, delayed by whole cycles. Both responses have the shape
    (cycles, steps, steps): the cycle and the step of the response, and the step of the impulse, or
    at which the force begins.
    """
    rest_of_cycle = np.cumsum(impulse[:, :, ::-1], axis=2)[:, :, ::-1]
    whole_cycle = np.cumsum(rest_of_cycle[:, :, 0], axis=0)
    later = np.concatenate([np.zeros((1, whole_cycle.shape[1])), whole_cycle[:-1]])
    return np.asarray(rest_of_cycle + later[:, :, None])


def _total(energy: Array) -> tuple[float, float]:
    """Sum a response's energies in all cycles and the tail after them; return its uncertainty too.

    In the end one real mode of the response is left, and the energy falls by a constant factor per
    cycle. If the energy takes more than `MOST_CYCLES` cycles to fall by the factor e, the
    uncertainty is infinite: the response would not settle in any record.
    """
    total = float(np.sum(energy))
    last = energy[-3:]
    if last[-1] <= 1e-12 * total:
        return total, 0.0
    before, factor = last[1:] / last[:-1]
    if factor >= 1.0 - 1.0 / MOST_CYCLES:
        return total, np.inf
    tail = float(last[-1] * factor / (1.0 - factor))
    return total + tail, float(tail * abs(factor - before) / (1.0 - factor))
