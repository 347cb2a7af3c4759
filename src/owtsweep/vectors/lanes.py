"""The operations on values of eight lanes that kernels import, in the form that was chosen."""

from __future__ import annotations

from owtsweep.vectors import uses_vectors

if uses_vectors():
    from owtsweep.vectors.rows import borrowed, element, groups, load, prefetch, store, zero
    from owtsweep.vectors.vector import ROOMY, rounded
else:
    from owtsweep.vectors.plain import (
        ROOMY,
        borrowed,
        element,
        groups,
        load,
        prefetch,
        rounded,
        store,
        zero,
    )

__all__ = [
    "AHEAD", "ROOMY", "borrowed", "element", "groups", "load", "prefetch", "rounded", "store",
    "zero",
]  # fmt: skip

#: Rows ahead of their use that streams from memory are asked for.
AHEAD = 64
