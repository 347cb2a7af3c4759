"""The whole chain of a scheme over a span of steps: filter, smoother, predictor."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import filter_chunk
from owtsweep.studies.hub.kernels.lagging import predict_chunk, shift, smooth_chunk


@njit
def chain_chunk(k0, count, force, fixes, zeros, arrays, predictor, mhe, memory):
    """Leave the estimates of steps k0 ... k0 + count - 1 in memory.position and .velocity."""
    filter_chunk(k0, count, force, fixes, zeros, arrays, mhe, memory)
    if arrays.window > 0:
        smooth_chunk(k0, count, arrays, memory)
    if predictor.steps > 0:
        predict_chunk(k0, count, force, zeros, predictor, memory)
    else:
        for i in range(count):
            for lane in range(force.shape[1]):
                memory.position[i, lane] = memory.X[i, 0, lane]
                memory.velocity[i, lane] = memory.X[i, 1, lane]
    if arrays.window > 0:
        shift(count, arrays, memory)
