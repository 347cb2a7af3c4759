"""Chains with settled gains, and the limits of sequences that are slow to settle."""

from __future__ import annotations

from dataclasses import replace
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain

Complex = NDArray[np.complex128]

#: Cycles from which a limit is extrapolated: two more than the modes that it removes.
KEPT_CYCLES = 10
#: No run is longer than this many cycles.
MOST_CYCLES = 4096


def settled(chain: Chain) -> Chain:
    """The chain after its transient: it uses the last cycle of its gains from the start.

    The growing windows of an MHE at the start are kept.
    """
    gains, last = chain.gains, slice(-chain.gains.cycle, None)
    filter_arrays = chain.filter
    schedules = ("K", "applied", "fresh", "innovation_variance", "predicted", "filtered")
    kept = replace(gains, **{name: getattr(gains, name)[last].copy() for name in schedules})
    changes: dict[str, Any] = {"K": kept.K, "applied": kept.applied}
    if filter_arrays.window > 0:
        changes |= {name: getattr(filter_arrays, name)[last].copy() for name in ("C", "D")}
    mhe = chain.mhe
    if mhe.active:
        maps = np.concatenate([mhe.maps[: mhe.horizon], mhe.maps[-1:]])
        mhe = mhe._replace(maps=np.ascontiguousarray(maps))
    return replace(chain, gains=kept, filter=filter_arrays._replace(**changes), mhe=mhe)


def cycle_of(chain: Chain) -> int:
    """Steps after which everything in the chain repeats: gains, fixes and MHE."""
    return lcm(chain.gains.cycle, chain.filter.fix_interval, chain.mhe.interval)


def filling(chain: Chain) -> int:
    """Steps until every register of the chain holds data."""
    fixes = chain.mhe.horizon + 1 if chain.mhe.active else 1
    return fixes * chain.filter.fix_interval + chain.filter.window + chain.predictor.steps


def longest(chain: Chain) -> int:
    """The most steps that a run may take to settle."""
    return MOST_CYCLES * cycle_of(chain)


def limit(sequence: Complex) -> tuple[Complex, Array]:
    """The limit of a sequence that comes from a linear system with few modes.

    This is reduced rank extrapolation. The weights have the sum 1 and minimise the weighted sum of
    the differences between terms. The limit is the weighted sum of the terms. It removes as many
    modes as there are differences, less one. (Smith, Ford and Sidi, 1987, Extrapolation methods for
    vector sequences, SIAM Review 29, 199-233.)

    Parameters
    ----------
    sequence
        (terms, m, n): n sequences of vectors of length m.

    Returns
    -------
    limit
        (m, n).
    remainder
        (n,): norm of the weighted sum of the differences over that of the limit. It bounds the
        error of the limit as long as no mode stays in phase with the sequence.
    """
    differences = np.diff(sequence, axis=0)
    n = sequence.shape[2]
    limits = np.empty(sequence.shape[1:], dtype=complex)
    remainder = np.empty(n)
    for i in range(n):
        D = differences[:, :, i].T
        # so that the weights sum to 1: the last difference, and the others minus it
        step = D[:, :-1] - D[:, -1:]
        g = np.linalg.lstsq(step, -D[:, -1], rcond=1e-12)[0]
        g = np.append(g, 1.0 - np.sum(g))
        limits[:, i] = sequence[:-1, :, i].T @ g
        scale = np.linalg.norm(limits[:, i])
        remainder[i] = np.linalg.norm(D @ g) / (scale if scale > 0.0 else 1.0)
    return limits, remainder
