"""Values of a run on their product grid, and the statistics along its replicates.

Sums run strictly in order of the replicates, so no bit depends on row order or on other cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

VALUE_COLUMNS = (
    "scheme",
    "natural_period",
    "amplitude",
    "measure",
    "window",
    "replicate",
    "value",
)
#: The order of measures in tables; others follow alphabetically.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: Intervals cover 95 %, tests reject at 5 %.
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Cube:
    """Values on their product grid, NaN where there is none; every axis has a fixed order.

    `values` is (scheme, natural period, amplitude, measure, window, replicate).
    """

    schemes: tuple[str, ...]
    natural_periods: list[float]
    amplitudes: list[float]
    measures: tuple[str, ...]
    windows: tuple[str, ...]
    values: Floats

    @property
    def axes(self) -> tuple[Sequence[Any], ...]:
        """The labels of all axes but the replicates."""
        return self.schemes, self.natural_periods, self.amplitudes, self.measures, self.windows

    @classmethod
    def of(cls, values: pd.DataFrame, schemes: Sequence[str]) -> Cube:
        import pandas as pd

        kept = values[values["scheme"].isin(list(schemes))]
        names = {
            "scheme": list(schemes),
            "measure": sorted(set(kept["measure"]), key=_measure_order),
            "window": sorted(set(kept["window"])),
        }
        labels: dict[str, Any] = dict(names)
        codes = {
            name: pd.Categorical(kept[name], categories=order).codes
            for name, order in names.items()
        }
        for name in ("natural_period", "amplitude", "replicate"):
            labels[name], codes[name] = np.unique(kept[name].to_numpy(), return_inverse=True)
        shape = tuple(len(labels[name]) for name in VALUE_COLUMNS[:-1])
        place = (
            np.ravel_multi_index(
                tuple(codes[name].astype(np.intp) for name in VALUE_COLUMNS[:-1]), shape
            )
            if len(kept)
            else np.zeros(0, dtype=np.intp)
        )
        if np.unique(place).size < place.size:
            raise InputError("rows: two values for one case; give each case of a run once")
        cube = np.full(int(np.prod(shape)), np.nan)
        cube[place] = kept["value"].to_numpy(dtype=float)
        return cls(
            schemes=tuple(schemes),
            natural_periods=labels["natural_period"].tolist(),
            amplitudes=labels["amplitude"].tolist(),
            measures=tuple(names["measure"]),
            windows=tuple(names["window"]),
            values=cube.reshape(shape),
        )


def _measure_order(measure: str) -> tuple[int, str]:
    return (MEASURES.index(measure) if measure in MEASURES else len(MEASURES), measure)


def ordered_sum(samples: Floats) -> Floats:
    """Sum over the last axis strictly in order, so that its bits depend on nothing else.

    `np.sum` groups its terms by the shape of the array; a running sum does not.
    """
    total: Floats = np.cumsum(samples, axis=-1)[..., -1]
    return total


def mean_and_error(samples: Floats) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Mean, its standard error (NaN for one sample) and count over the last axis without NaN."""
    present = np.isfinite(samples)
    n = present.sum(axis=-1)
    mean = ordered_sum(np.where(present, samples, 0.0)) / n
    deviation = np.where(present, samples - mean[..., np.newaxis], 0.0)
    error = np.sqrt(ordered_sum(deviation**2) / np.where(n > 1, n * (n - 1.0), np.nan))
    return mean, error, n


def t_quantile(freedom: NDArray[np.intp]) -> Floats:
    from scipy.special import stdtrit

    quantile: Floats = stdtrit(np.maximum(freedom, 1), 0.5 + CONFIDENCE / 2.0)
    return quantile


def p_value(difference: float, error: float, n: int) -> float:
    """Two-sided paired t-test; 1 where nothing can be tested."""
    from scipy.special import stdtr

    if n < 2:
        return 1.0
    if error == 0.0:
        return 1.0 if difference == 0.0 else 0.0
    return float(2.0 * stdtr(n - 1, -abs(difference) / error))
