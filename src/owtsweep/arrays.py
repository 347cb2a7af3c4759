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
    """Zeros (*shape) that begin at a cache line, for what kernels read and write.

    A row of eight lanes is as long as a line. If it began elsewhere it would lie across two lines,
    and every access would touch both.
    """
    size = 8 * math.prod(shape)
    raw = np.zeros(size + LINE, dtype=np.uint8)
    skipped = -raw.ctypes.data % LINE
    return raw[skipped : skipped + size].view(np.float64).reshape(shape)
