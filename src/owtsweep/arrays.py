"""The array type of all signatures, real numbers in double precision, and where arrays begin."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: `np.floating` rather than `np.float64`, because that is what NumPy's own functions promise.
Array = NDArray[np.floating[Any]]

#: Bytes of a cache line.
LINE = 64


def aligned(*shape: int) -> Array:
    """Zeros (*shape) that begin where a cache line begins, for what kernels read and write.

    Rows of eight lanes are one line long. Wherever else they began, each would lie across two, and
    every access would be two.
    """
    size = 8 * math.prod(shape)
    raw = np.zeros(size + LINE, dtype=np.uint8)
    skipped = -raw.ctypes.data % LINE
    return raw[skipped : skipped + size].view(np.float64).reshape(shape)
