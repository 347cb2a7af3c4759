"""Defines the array type of all signatures (real, double precision); makes aligned arrays."""

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
    """Return zeros of the given shape that begin at a cache line, for use by compiled kernels.

    A row of eight numbers is as long as a cache line. A row that began elsewhere would lie across
    two cache lines, and every access would touch both.
    """
    size = 8 * math.prod(shape)
    raw = np.zeros(size + LINE, dtype=np.uint8)
    skipped = -raw.ctypes.data % LINE
    return raw[skipped : skipped + size].view(np.float64).reshape(shape)
