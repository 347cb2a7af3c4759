"""The batch engine: one chain over all replicates of a block, errors summed on the fly."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.kernels.layout import Memory, new_memory
from owtsweep.studies.hub.records import Records

#: Steps that the kernels work through at once: the buffers of some 24 lanes fit the second cache.
CHUNK = 500


class Sums(NamedTuple):
    """Sums over a record and how many terms they have.

    products (2 windows, 6 quantities, 3 products, replicates) as in `kernels.sums`; steps and
    innovations (2,): terms per window; squared (steps or 0, replicates): squared position error.
    """

    products: Array
    steps: NDArray[np.int64]
    innovations: NDArray[np.int64]
    squared: Array


class Lanes:
    """The records of a block as lanes in NED, (steps, lanes) and (fixes, lanes).

    Noise lanes are ordered by replicate, then axis; the motion has one lane per replicate, the
    unit displacement along the wave, since both axes share their gains.
    """

    def __init__(self, records: Records) -> None:
        self.records = records

    @cached_property
    def position(self) -> Array:
        """True displacement along the wave, (steps, replicates), m."""
        return np.stack([motion.position for motion in self.records.motion], axis=1)

    @cached_property
    def velocity(self) -> Array:
        """Its rate, (steps, replicates), m/s."""
        return np.stack([motion.velocity for motion in self.records.motion], axis=1)

    @cached_property
    def _noise_force(self) -> Array:
        R = self.records.sensors.rotation
        return np.concatenate([noise.specific_force @ R.T for noise in self.records.noise], axis=1)

    @cached_property
    def _noise_fixes(self) -> Array:
        return np.concatenate([noise.fixes for noise in self.records.noise], axis=1)

    @cached_property
    def _motion_force(self) -> Array:
        return np.stack([motion.acceleration for motion in self.records.motion], axis=1)

    @cached_property
    def _motion_fixes(self) -> Array:
        s = self.records.sensors
        count = len(self.records.noise[0].fixes)
        return np.stack(
            [m.position_at(-s.delay, s.fix_interval, count) for m in self.records.motion], axis=1
        )

    @cached_property
    def superposed(self) -> tuple[Array, Array]:
        """Force and fixes with lanes [motion | noise]."""
        return (
            np.concatenate([self._motion_force, self._noise_force], axis=1),
            np.concatenate([self._motion_fixes, self._noise_fixes], axis=1),
        )

    def at(self, amplitude: float) -> tuple[Array, Array]:
        """Force and fixes of whole series at an amplitude (m), lanes by replicate and axis."""
        direction = np.tile(self.records.direction, len(self.records.replicates))
        return (
            amplitude * np.repeat(self._motion_force, 2, axis=1) * direction + self._noise_force,
            amplitude * np.repeat(self._motion_fixes, 2, axis=1) * direction + self._noise_fixes,
        )


def superposed_sums(chain: Chain, lanes: Lanes, settled: int, *, consistency: bool = True) -> Sums:
    """Products of the motion's and the noise's errors; `settled` is the first settled step.

    Without `consistency` NEES is left at zero and its covariances are not computed.
    """
    force, fixes = lanes.superposed
    return _run(chain, lanes, force, fixes, settled, None, consistency=consistency)


def direct_sums(
    chain: Chain, lanes: Lanes, amplitude: float, settled: int, *, keep_squared: bool = False
) -> Sums:
    """Squared errors at one amplitude (m), as product 2."""
    force, fixes = lanes.at(amplitude)
    return _run(chain, lanes, force, fixes, settled, (amplitude, keep_squared))


def _run(
    chain: Chain,
    lanes: Lanes,
    force: Array,
    fixes: Array,
    settled: int,
    direct: tuple[float, bool] | None,
    *,
    consistency: bool = True,
) -> Sums:
    from owtsweep.studies.hub.kernels import sums as kernel

    steps = len(force)
    replicates = len(lanes.records.replicates)
    products = np.zeros((2, 6, 3, replicates))
    weight = 1.0 / chain.gains.innovation_variance
    precision = chain.precision if consistency else np.zeros((chain.gains.rows, 3))
    amplitude, keep = direct or (1.0, False)
    squared = np.empty((steps if keep else 0, replicates))
    truth = (lanes.position, lanes.velocity)
    common = (
        lanes.records.direction * amplitude, precision, weight, chain.gains.fresh,
        chain.gains.cycle,
    )  # fmt: skip
    for k0, count, memory in chunks(chain, force, fixes):
        if direct is None:
            kernel.superposed(k0, count, settled, *truth, *common, memory, products)
        else:
            kernel.direct(k0, count, settled, *truth, *common, memory, products, squared)
    fresh = chain.gains.fresh[chain.gains.row(np.arange(steps))]
    late = int(np.count_nonzero(fresh[settled:]))
    return Sums(
        products=products,
        steps=np.array([settled, steps - settled]),
        innovations=np.array([int(np.count_nonzero(fresh)) - late, late]),
        squared=squared,
    )


def trajectories(
    chain: Chain, sensors: Sensors, force: Array, fixes: Array
) -> tuple[Array, Array, Array]:
    """Estimates of position and velocity and the filter's innovation, (steps, lanes) each.

    Parameters
    ----------
    force, fixes
        (steps, lanes) specific force in NED, m/s^2; (fixes, lanes) positions, m.
    """
    steps, width = force.shape
    result = (np.empty((steps, width)), np.empty((steps, width)), np.empty((steps, width)))
    for k0, n, memory in chunks(chain, force, fixes):
        for out, source in zip(
            result, (memory.position, memory.velocity, memory.innovation), strict=True
        ):
            out[k0 : k0 + n] = source[:n]
    return result


def chunks(chain: Chain, force: Array, fixes: Array) -> Iterator[tuple[int, int, Memory]]:
    """Run a chain over lanes chunk by chunk: first step, number of steps, the chain's memory.

    `memory.position`, `.velocity` and `.innovation` hold the chunk until the next is asked for.
    """
    from owtsweep.studies.hub.kernels.chain import chain_chunk

    steps, width = force.shape
    chunk, memory = _new_chunk(chain, width)
    zeros = np.zeros(width)
    for k0 in range(0, steps, chunk):
        n = min(chunk, steps - k0)
        chain_chunk(k0, n, force, fixes, zeros, chain.filter, chain.predictor, chain.mhe, memory)
        yield k0, n, memory


def states(chain: Chain, force: Array, fixes: Array) -> Array:
    """The filter's states (p, v, a, b), smoothed if the chain has a smoother.

    Row k is the state of step k - window in the filter's own time, which is the chain's input
    delay (and the fixes' delay) late; the first `window` rows are zero.

    Returns
    -------
    Array
        (steps, 4, lanes) in m, m/s, m/s^2, m/s^2; b is x4 of Eq. (6), -R b^b + g.
    """
    from owtsweep.studies.hub.kernels.filtering import filter_chunk
    from owtsweep.studies.hub.kernels.lagging import shift, smooth_chunk

    steps, width = force.shape
    chunk, memory = _new_chunk(chain, width)
    zeros = np.zeros(width)
    result = np.empty((steps, 4, width))
    for k0 in range(0, steps, chunk):
        n = min(chunk, steps - k0)
        filter_chunk(k0, n, force, fixes, zeros, chain.filter, chain.mhe, memory)
        if chain.filter.window > 0:
            smooth_chunk(k0, n, chain.filter, memory)
        result[k0 : k0 + n] = memory.X[:n]
        if chain.filter.window > 0:
            shift(n, chain.filter, memory)
    return result


def _new_chunk(chain: Chain, lanes: int) -> tuple[int, Memory]:
    """How many steps to work through at once, and the memory for that."""
    window, prediction = chain.filter.window, chain.predictor.steps
    chunk = max(CHUNK, 2 * window, 2 * prediction)
    return chunk, new_memory(lanes, chunk, window, prediction, chain.mhe.horizon)
