"""Find which of several series are equal, piece by piece."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from owtsweep.arrays import Array


class Alike:
    """Compares named series; two series are alike if all their pieces are equal."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self._pairs = set(combinations(range(len(names)), 2))

    def add(self, pieces: Sequence[Array]) -> None:
        """Take the next piece of every series."""
        self._pairs = {
            (i, j)
            for i, j in self._pairs
            if np.allclose(pieces[i], pieces[j], rtol=1e-9, atol=1e-12, equal_nan=True)
        }

    def repeated(self) -> frozenset[str]:
        """Names of the series that are equal to a later one."""
        return frozenset(self.names[i] for i, _ in self._pairs)
