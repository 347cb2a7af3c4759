"""The array type of all signatures: real numbers in double precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: `np.floating` rather than `np.float64`, because that is what NumPy's own functions promise.
Array = NDArray[np.floating[Any]]
