"""What a criterion is: a measure by which schemes are judged, and how its error is printed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class Criterion:
    """A measure by which schemes are judged.

    title: What the title of a map says of it.
    values: What a row holds of a record: "square" (a mean square), "root" (the root of a mean
        square), "plain" (neither). The error of several records is the root of the mean of their
        mean squares, or the mean of plain values.
    unit: Unit of the error; "" for a ratio.
    floor, reason: the least difference of two errors that matters to a user, and why.
    """

    title: str
    values: Literal["square", "root", "plain"]
    unit: str
    floor: float
    reason: str

    @property
    def squared(self) -> bool:
        """Whether the values that are judged are squares, of whose mean the error is the root."""
        return self.values != "plain"

    def judge(self, values: Array) -> Array:
        """Return what is judged of values of any shape: squares, or the values as they are."""
        return values**2 if self.values == "root" else values

    def express(self, mean: Array | float) -> Array:
        """Return the errors, in `unit`, of means of what is judged; NaN for a negative mean."""
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(mean) if self.squared else mean)

    def show(self, error: float) -> str:
        """Return an error as text with three digits that count and its unit."""
        return f"{show_error(error)} {self.unit}".strip()


def show_error(error: float) -> str:
    """Return an error with three digits that count, e.g. "0.0141", "1.20" or "0"."""
    return f"{error:#.3g}".rstrip(".") if error else "0"


#: Floors of lengths and speeds, with the reason.
MILLIMETRE = (0.001, "a millimetre is below what guide pins and bolts leave")
MILLIMETRE_PER_SECOND = (0.001, "mating speeds are of some .1 m/s, a hundredth of that is .001")
