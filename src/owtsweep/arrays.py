"""Defines `Array`, the type of arrays in signatures, and makes arrays aligned in memory."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: `np.floating` rather than `np.float64`, because NumPy's functions are annotated with it.
Array = NDArray[np.floating[Any]]

#: Bytes of a cache line.
LINE = 64


def aligned(*shape: int) -> Array:
    """Return an array of zeros whose memory begins at a cache line, for use by compiled kernels.

    `shape` gives the lengths of the axes. A row of eight numbers is as long as a cache line. A row
    that began inside a cache line would lie across two cache lines, and each access to the row
    would touch both.
    """
    size = 8 * math.prod(shape)
    raw = np.zeros(size + LINE, dtype=np.uint8)
    skipped = -raw.ctypes.data % LINE
    return raw[skipped : skipped + size].view(np.float64).reshape(shape)
