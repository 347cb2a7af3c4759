"""Values of eight lanes for compiled kernels, in one of two forms that give the same bits.

`rows` and `vector` make them LLVM vectors, through interfaces of numba and llvmlite that may
change; `plain` makes them tuples of floats. Kernels import the chosen form from `lanes`. See
docs/vectors.md.
"""

from __future__ import annotations

import sys

from owtsweep import compiled
from owtsweep.errors import InputError

#: Lanes of a value: one register of 512 bits, two of 256, four of 128.
WIDTH = 8

#: Suffix of the folder of compiled kernels if they are plain loops.
_PLAIN = "-plain"


def choose(vectors: bool) -> None:
    """Choose LLVM vectors or plain loops; call it before the first kernel is imported.

    Raises
    ------
    InputError
        If this process has already imported kernels of the other form.
    """
    if vectors == uses_vectors():
        return
    if f"{__name__}.lanes" in sys.modules:
        raise InputError(
            f"compute.vectors: this process has compiled its kernels with "
            f"vectors={str(not vectors).lower()}; start another process"
        )
    compiled.variant = "" if vectors else _PLAIN


def uses_vectors() -> bool:
    """Whether kernels are compiled with LLVM vectors."""
    return compiled.variant != _PLAIN
