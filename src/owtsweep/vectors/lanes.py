"""The operations on values of eight lanes, for kernels to import: with LLVM vectors or without."""

from __future__ import annotations

from owtsweep.vectors import uses_vectors

if uses_vectors():
    from owtsweep.vectors.rows import (
        borrowed,
        borrowed_type,
        element,
        groups,
        load,
        prefetch,
        store,
        zero,
    )
    from owtsweep.vectors.vector import ROOMY, rounded
else:
    from owtsweep.vectors.plain import (
        ROOMY,
        borrowed,
        borrowed_type,
        element,
        groups,
        load,
        prefetch,
        rounded,
        store,
        zero,
    )

__all__ = [
    "AHEAD", "ROOMY", "borrowed", "borrowed_type", "element", "groups", "load", "prefetch",
    "rounded", "store", "zero",
]  # fmt: skip

#: Data is prefetched from memory this many rows before the row in use.
AHEAD = 64
