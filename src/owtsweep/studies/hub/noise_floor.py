"""The settled MSE of a scheme at rest: what sensor noise alone makes, computed without sampling.

The covariance of the settled periodic system is summed from its impulse responses: by periodicity
the mean over a cycle of the variance at each step is the energy of the responses to one unit
impulse at each step of one cycle, over the length of the cycle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.settled import cycle_of, filling, settled

SOURCES = ("gnss", "imu", "bias")
#: Greatest uncertainty of what is left of a response's energy, relative to the whole.
TOLERANCE = 1e-3
#: Cycles that the responses are followed for, at first and at most.
FIRST_CYCLES = 64
MOST_CYCLES = 1024


@dataclass(frozen=True)
class NoiseFloor:
    """Settled MSE from noise alone, x + y, by source and in all.

    Attributes
    ----------
    position, velocity
        Source -> m^2 and (m/s)^2: `gnss` (white, per fix), `imu` (white, per sample), `bias` (its
        Wiener process; a constant bias leaves nothing behind, or the scheme does not settle).
    """

    position: dict[str, float]
    velocity: dict[str, float]

    def of(self, measure: str) -> float:
        """The sum over all sources, of `position` or `velocity`."""
        return sum({"position": self.position, "velocity": self.velocity}[measure].values())


def noise_floor(chain: Chain, sensors: Sensors) -> NoiseFloor:
    """The noise floor of a chain, exact but for the last modes' tail, which is extrapolated.

    Raises
    ------
    InputError
        If the responses do not die out within `MOST_CYCLES` cycles: an estimator that is not
        stable, or whose bias is too slow to settle.
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
    """Energy per cycle of the responses to unit impulses in the first, (cycles,) each."""
    cycle, M = cycle_of(chain), sensors.fix_interval
    start = -(-filling(chain) // cycle) * cycle
    fixes_in_cycle = cycle // M
    steps = start + cycles * cycle
    force = np.zeros((steps, cycle + fixes_in_cycle))
    fixes = np.zeros((-(-steps // M), cycle + fixes_in_cycle))
    force[start : start + cycle, :cycle] = np.eye(cycle)
    fixes[start // M : start // M + fixes_in_cycle, cycle:] = np.eye(fixes_in_cycle)

    answers = np.empty((2, steps, force.shape[1]))
    for k0, n, memory in batch.chunks(chain, force, fixes):
        answers[0, k0 : k0 + n] = memory.position[:n]
        answers[1, k0 : k0 + n] = memory.velocity[:n]
    result = {}
    for out, answer in zip(("position", "velocity"), answers[:, start:], strict=True):
        shaped = answer.reshape(cycles, cycle, -1)
        force_response = shaped[:, :, :cycle]
        result["imu", out] = _per_cycle(force_response)
        result["gnss", out] = _per_cycle(shaped[:, :, cycle:])
        result["bias", out] = _per_cycle(_step_responses(force_response))
    return result


def _per_cycle(response: Array) -> Array:
    return np.asarray(np.sum(response**2, axis=(1, 2)))


def _step_responses(impulse: Array) -> Array:
    """Responses to a force that stays from each step of the first cycle on, as a bias does.

    Such a step is an impulse at every later step of the cycle, and of all cycles after it, whose
    responses are those to the first cycle's impulses, late.

    Parameters
    ----------
    impulse
        (cycles, cycle, cycle): response by cycle and step to an impulse at each step.
    """
    rest_of_cycle = np.cumsum(impulse[:, :, ::-1], axis=2)[:, :, ::-1]
    whole_cycle = np.cumsum(rest_of_cycle[:, :, 0], axis=0)
    later = np.concatenate([np.zeros((1, whole_cycle.shape[1])), whole_cycle[:-1]])
    return np.asarray(rest_of_cycle + later[:, :, None])


def _total(energy: Array) -> tuple[float, float]:
    """Sum of energies per cycle with the tail that is not there, and the tail's uncertainty.

    In the end one real mode is left, and energies fall by a constant factor. One that takes more
    than `MOST_CYCLES` to fall by e is none that a record would ever see settle.
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
