"""Makes chains with settled gains, and extrapolates sequences that settle slowly."""

from __future__ import annotations

from dataclasses import replace
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain

Complex = NDArray[np.complex128]

#: Number of cycles from which a limit is extrapolated: two more than the modes that are removed.
KEPT_CYCLES = 10
#: No response is computed for more than this many cycles until it has settled.
MOST_CYCLES = 4096


def settled(chain: Chain) -> Chain:
    """Return a chain whose gains are settled from the first step on: its last cycle, repeated.

    If the chain has an MHE, the MHE's window still grows at the start.
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
    """Return the period, in steps, of all that repeats in a chain: gains, position fixes, MHE."""
    return lcm(chain.gains.cycle, chain.filter.fix_interval, chain.mhe.interval)


def filling(chain: Chain) -> int:
    """Return the number of steps after which all windows and delays of a chain are full."""
    fixes = chain.mhe.horizon + 1 if chain.mhe.active else 1
    return fixes * chain.filter.fix_interval + chain.filter.window + chain.predictor.steps


def limit(sequence: Complex) -> tuple[Complex, Array]:
    """Compute the limits of sequences from their first terms, by reduced rank extrapolation.

    The sequences must come from a linear system with few modes. The limit is a weighted sum of the
    terms. The weights have the sum 1 and minimise the norm of the weighted sum of the differences
    between successive terms. With d differences, d - 1 modes are removed. Source: Smith, Ford and
    Sidi (1987), Extrapolation methods for vector sequences, SIAM Review 29, 199-233.

    sequence: the terms of n sequences of vectors of length m, shape (terms, m, n).
    limit: the limits, shape (m, n).
    remainder: norm of the weighted sum of the differences, divided by the norm of the limit, shape
        (n,). It bounds the limit's relative error as long as no mode stays in phase with the
        sequence.
    """
    differences = np.diff(sequence, axis=0)
    n = sequence.shape[2]
    limits = np.empty(sequence.shape[1:], dtype=complex)
    remainder = np.empty(n)
    for i in range(n):
        D = differences[:, :, i].T
        # the last weight is 1 minus the others, so that all sum to 1
        step = D[:, :-1] - D[:, -1:]
        g = np.linalg.lstsq(step, -D[:, -1], rcond=1e-12)[0]
        g = np.append(g, 1.0 - np.sum(g))
        limits[:, i] = sequence[:-1, :, i].T @ g
        scale = np.linalg.norm(limits[:, i])
        remainder[i] = np.linalg.norm(D @ g) / (scale if scale > 0.0 else 1.0)
    return limits, remainder
