"""Values of a run on their product grid, and the statistics along its replicates.

Sums run strictly in order of the replicates, so no bit depends on row order or on other cells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.config import require
from owtsweep.sweep.study import OK

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


#: The products of motion and noise that make a superposed value.
PRODUCTS = ("motion", "cross", "noise")
_GRID = ("scheme", "natural_period", "amplitude", "measure", "window", "replicate")


@dataclass(frozen=True)
class Cube:
    """Values on their product grid, NaN where there is none; every axis has a fixed order.

    The values of a superposed scheme are made amplitude by amplitude when they are asked for: ten
    amplitudes of a large study would not fit into memory together.

    Attributes
    ----------
    schemes, natural_periods, amplitudes, measures, windows
        The labels of the axes.
    products
        (3, scheme, natural period, measure, window, replicate): `PRODUCTS`; None without
        superposed rows.
    direct
        (scheme, natural period, amplitude, measure, window, replicate): values of rows at one
        amplitude; None without such rows.
    """

    schemes: tuple[str, ...]
    natural_periods: list[float]
    amplitudes: list[float]
    measures: tuple[str, ...]
    windows: tuple[str, ...]
    products: Floats | None
    direct: Floats | None

    @property
    def axes(self) -> tuple[Sequence[Any], ...]:
        """The labels of all axes but the replicates."""
        return self.schemes, self.natural_periods, self.amplitudes, self.measures, self.windows

    @property
    def empty(self) -> bool:
        """Whether there is no value at all."""
        return self.products is None and self.direct is None

    def values(self, scheme: int, period: int, measures: Any = slice(None)) -> Floats:
        """(amplitude, measure, window, replicate): all values of one scheme at one period.

        Parameters
        ----------
        scheme, period
            Indices on their axes.
        measures
            Which measures: a slice or a list of indices.
        """
        here = (scheme, period)
        found: Floats | None = None
        if self.products is not None:
            found = _superposed(self.products[(slice(None), *here)][:, measures], self.amplitudes)
        if self.direct is not None:
            direct = self.direct[here][:, measures]
            found = direct if found is None else np.where(np.isfinite(direct), direct, found)
        if found is None:
            raise ValueError("the cube is empty")
        return found

    @classmethod
    def of(cls, values: pd.DataFrame, schemes: Sequence[str]) -> Cube:
        """The cube of values as `aggregate.expand` returns them."""
        kept = np.isfinite(values["value"].to_numpy(dtype=float))
        return cls._build(values, schemes, np.zeros(len(values), dtype=bool), kept)

    @classmethod
    def of_rows(
        cls, rows: pd.DataFrame, schemes: Sequence[str], amplitudes: Sequence[float]
    ) -> Cube:
        """The cube of a run's rows: what `of` makes of `expand`, in a tenth of the memory.

        Parameters
        ----------
        rows
            The rows of a run's cases; those that failed or have no finite number are left out.
        schemes
            The schemes that take part.
        amplitudes
            The grid's amplitudes (m); direct rows at others are left out.
        """
        finished = (rows["status"] == OK).to_numpy()
        at_one = rows["amplitude"].notna().to_numpy()
        superposed = finished & ~at_one
        for name in PRODUCTS:
            superposed &= np.isfinite(rows[name].to_numpy(dtype=float))
        direct = finished & at_one & rows["amplitude"].isin(list(amplitudes)).to_numpy()
        direct &= np.isfinite(rows["value"].to_numpy(dtype=float))
        return cls._build(rows, schemes, superposed, direct, amplitudes)

    @classmethod
    def _build(
        cls,
        rows: pd.DataFrame,
        schemes: Sequence[str],
        superposed: NDArray[np.bool_],
        direct: NDArray[np.bool_],
        amplitudes: Sequence[float] = (),
    ) -> Cube:
        taking_part = rows["scheme"].isin(list(schemes)).to_numpy()
        superposed, direct = superposed & taking_part, direct & taking_part
        used = superposed | direct
        labels: dict[str, list[Any]] = {
            "scheme": list(schemes),
            "measure": sorted(_of(rows, "measure", used).unique(), key=_measure_order),
            "window": sorted(_of(rows, "window", used).unique()),
            "amplitude": np.unique(
                amplitudes if superposed.any() else _of(rows, "amplitude", direct)
            ).tolist(),
        }
        for name in ("natural_period", "replicate"):
            labels[name] = np.unique(_of(rows, name, used)).tolist()
        per_record = [name for name in _GRID if name != "amplitude"]
        products = values = None
        if superposed.any():
            place, shape = _places(rows, superposed, labels, per_record)
            products = np.full((len(PRODUCTS), *shape), np.nan)
            for part, name in zip(products, PRODUCTS, strict=True):
                part.reshape(-1)[place] = _of(rows, name, superposed)
        if direct.any():
            place, shape = _places(rows, direct, labels, _GRID)
            values = np.full(shape, np.nan)
            values.reshape(-1)[place] = _of(rows, "value", direct)
        if products is not None and values is not None:
            both = np.isfinite(products[0])[:, :, np.newaxis] & np.isfinite(values)
            _require_once(not both.any())
        return cls(
            schemes=tuple(schemes),
            natural_periods=labels["natural_period"],
            amplitudes=labels["amplitude"],
            measures=tuple(labels["measure"]),
            windows=tuple(labels["window"]),
            products=products,
            direct=values,
        )


def _superposed(products: Floats, amplitudes: Sequence[float]) -> Floats:
    """(amplitude, measure, window, replicate) of products (3, measure, window, replicate).

    The longer of the outer axes lies innermost in memory, where loops and sums are fastest.
    """
    N = np.asarray(amplitudes)
    if len(N) <= products.shape[-1]:
        motion, cross, noise = products[:, np.newaxis]
        N = N[:, np.newaxis, np.newaxis, np.newaxis]
        return np.asarray(N**2 * motion + 2.0 * N * cross + noise)
    motion, cross, noise = products.transpose(0, 3, 1, 2)[..., np.newaxis]
    return np.asarray(N**2 * motion + 2.0 * N * cross + noise).transpose(3, 1, 2, 0)


def _places(
    rows: pd.DataFrame,
    chosen: NDArray[np.bool_],
    labels: Mapping[str, Sequence[Any]],
    names: Sequence[str],
) -> tuple[NDArray[np.intp], tuple[int, ...]]:
    """Where the chosen rows stand in an array over these axes, and its shape."""
    import pandas as pd

    place = np.zeros(int(chosen.sum()), dtype=np.intp)
    for name in names:
        column = _of(rows, name, chosen)
        if name in ("scheme", "measure", "window"):
            known = pd.Categorical(column)  # of its own categories, which may be more than ours
            codes = pd.Index(labels[name]).get_indexer(known.categories)[known.codes]
        else:
            codes = np.searchsorted(np.asarray(labels[name]), column)
        place *= len(labels[name])
        place += codes
    shape = tuple(len(labels[name]) for name in names)
    taken = np.zeros(shape, dtype=bool).reshape(-1)
    taken[place] = True
    _require_once(int(taken.sum()) == place.size)
    return place, shape


def _of(rows: pd.DataFrame, name: str, chosen: NDArray[np.bool_]) -> Any:
    """A column of the chosen rows; no copy where that is all of them."""
    column = rows[name].array
    return column if chosen.all() else column[chosen]


def _require_once(once: bool) -> None:
    require(once, "rows: two values for one case; give each case of a run once")


def _measure_order(measure: str) -> tuple[int, str]:
    return (MEASURES.index(measure) if measure in MEASURES else len(MEASURES), measure)


def ordered_sum(samples: Floats) -> Floats:
    """Sum over the last axis strictly in order, so that its bits depend on nothing else.

    `np.sum` groups its terms by the shape of the array; a running sum does not.
    """
    total: Floats
    if samples.ndim > 1 and samples.strides[-1] > min(samples.strides[:-1]):
        # The samples of all cells lie side by side: the same sums, all cells at once.
        total = samples[..., 0].copy(order="K")
        for place in range(1, samples.shape[-1]):
            total += samples[..., place]
    else:
        total = np.cumsum(samples, axis=-1)[..., -1]
    return total


def mean_and_error(samples: Floats) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Mean, its standard error (NaN for one sample) and count over the last axis without NaN."""
    present = np.isfinite(samples)
    n = present.sum(axis=-1)
    whole = bool(present.all())
    mean = ordered_sum(samples if whole else np.where(present, samples, 0.0)) / n
    deviation = samples - mean[..., np.newaxis]
    if not whole:
        deviation = np.where(present, deviation, 0.0)
    with np.errstate(over="ignore"):  # a scheme that diverges: no end of its interval is known
        spread = ordered_sum(np.square(deviation, out=deviation))
    error = np.sqrt(spread / np.where(n > 1, n * (n - 1.0), np.nan))
    return mean, error, n


def t_quantile(freedom: NDArray[np.intp]) -> Floats:
    from scipy.special import stdtrit

    # A large table has few different counts, and the quantile is dear.
    counts, place = np.unique(np.maximum(freedom, 1), return_inverse=True)
    quantile: Floats = stdtrit(counts, 0.5 + CONFIDENCE / 2.0)[place]
    return quantile.reshape(np.shape(freedom))


def p_values(difference: Floats, error: Floats, n: NDArray[np.intp]) -> Floats:
    """Two-sided paired t-tests; 1 where nothing can be tested."""
    from scipy.special import stdtr

    with np.errstate(divide="ignore", invalid="ignore"):
        p = 2.0 * stdtr(np.maximum(n - 1, 1), -np.abs(difference) / error)
    without_spread = np.where(difference == 0.0, 1.0, 0.0)
    tested: Floats = np.where(error == 0.0, without_spread, p)
    return np.where(n < 2, 1.0, tested)
