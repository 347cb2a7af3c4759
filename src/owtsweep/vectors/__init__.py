"""Values of eight floats at once ("lanes") for kernels, in two forms with equal results.

In the first form a value is an LLVM vector. The modules `rows` and `vector` make this form, through
interfaces of numba and llvmlite that may change. In the second form, made by the module `plain`, a
value is a tuple of floats. Both forms give equal numbers, bit for bit. Kernels import the chosen
form from the module `lanes`. See docs/vectors.md.
"""

from __future__ import annotations

import sys

from owtsweep import compiled
from owtsweep.errors import InputError

#: Number of lanes of a value. They fill one register of 512 bits, two of 256 or four of 128.
WIDTH = 8

#: End of the name of the folder of compiled kernels, if kernels are compiled without vectors.
_PLAIN = "-plain"


def choose(vectors: bool) -> None:
    """Choose whether kernels are compiled with LLVM vectors (True) or without (False).

    Call this before the first kernel is imported.

    Raises
    ------
    InputError
        If this process has already imported kernels, and they were compiled the other way.
    """
    if vectors == uses_vectors():
        return
    if f"{__name__}.lanes" in sys.modules:
        raise InputError(
            f"compute.vectors: this process has already compiled kernels with "
            f"vectors={str(not vectors).lower()}; start another process"
        )
    compiled.variant = "" if vectors else _PLAIN


def uses_vectors() -> bool:
    """Return whether kernels are compiled with LLVM vectors."""
    return compiled.variant != _PLAIN
