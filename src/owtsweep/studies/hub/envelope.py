"""Holds the envelope of a structure against a run's map: the best scheme in each sea, in words."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.motion.envelope import compute_points, list_seas
from owtsweep.streams import stream
from owtsweep.structures import Structure
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import find_winners

#: What stands for the best scheme of a point where the map names none: the point lies outside the
#: map, or in a cell without a result.
UNNAMED = ""
#: Value of the key `normalise` -> the column of the points that the run's amplitudes are.
SIZES = {"peak": "amplitude", "rms": "rms"}


def compute_envelope(config: HubConfig, structure: Structure) -> pd.DataFrame:
    """Compute the points of a structure, with the seed and the length of records of a run.

    The points are as `owtsweep.motion.envelope.compute_points` describes them. Raises InputError if
    the structure does not stand in water, or the run's records are too short for waves.
    """
    draw = partial(stream, config.seed, "hub", (), 0)
    return compute_points(structure, list_seas(), draw, duration=config.record.duration)


def find_best(config: HubConfig, best: pd.DataFrame, points: pd.DataFrame) -> list[str]:
    """Return what a run's map names at each point: a scheme, or a baseline that has less error.

    A point belongs to the cell whose centre is nearest, with amplitudes on a logarithmic scale. It
    gets `UNNAMED` outside the map or in a cell without a result.

    config: the configuration of the run, of one tuning.
    best: the run's table best_scheme.
    points: the points, as `compute_envelope` returns them.
    Raises InputError if the run has one natural period or one amplitude, so that its map has no
    area.
    """
    measures = config.measures
    cells = find_winners(config, best, measures.criterion, measures.window).table
    require(len(cells) > 0, "best_scheme: the run has no cell that its criterion and window judge")
    named = cells.pivot(index="natural_period", columns="amplitude", values="best")
    across, upwards = named.index.to_numpy(dtype=float), named.columns.to_numpy(dtype=float)
    for name, values in (("natural_period", across), ("amplitude", upwards)):
        require(
            len(values) > 1,
            f"grid.{name}: the run has one value, so its map has no area for an envelope; give "
            "two or more",
        )
    columns = _find_cells(points["natural_period"].to_numpy(), across)
    lines = _find_cells(np.log(points[SIZES[config.normalise]].to_numpy()), np.log(upwards))
    named = named.fillna(UNNAMED)
    return [
        str(named.iat[int(i), int(j)]) if np.isfinite(i + j) else UNNAMED
        for i, j in zip(columns, lines, strict=True)
    ]


def _find_cells(values: Array, centres: Array) -> Array:
    """Return the number of the nearest centre for each value; NaN beyond the outer cells' edges."""
    steps = np.diff(centres)
    low, high = centres[0] - 0.5 * steps[0], centres[-1] + 0.5 * steps[-1]
    nearest = np.abs(values[:, None] - centres).argmin(axis=1)
    return np.where((values >= low) & (values <= high), nearest, np.nan)


def tell_best(points: pd.DataFrame, tuning: str, size: str = "amplitude") -> str:
    """Say in two sentences which scheme is best for a structure, and in which sea.

    The points have a column `best_<tuning>`; `size` is the column "amplitude" or "rms".
    """
    best = points[f"best_{tuning}"]
    shares = best[best != UNNAMED].value_counts() / len(best)
    if shares.empty:
        return f"Tuning {tuning}: the map names a scheme at none of the {len(best)} points."
    parts = [
        f"{name} in {100.0 * share:.0f} % ({_tell_range(points.loc[best == name, size])})"
        for name, share in shares.items()
    ]
    beyond = _tell_unnamed(best, "points")
    if beyond:
        beyond += f" ({_tell_range(points.loc[best == UNNAMED, size])})"
    first = f"Tuning {tuning}: over all seas, blades and soils, best is {', '.join(parts)}{beyond}."
    bare = points[(points["blades"] == 0) & points["friction_angle"].isna()]
    return f"{first} {_tell_seas(bare, f'best_{tuning}')}"


def _tell_unnamed(best: pd.Series[str], what: str) -> str:
    """Say at how many of the points the map names no scheme; "" if it names one at each."""
    count = int((best == UNNAMED).sum())
    share = f"{count} of {len(best)} {what} ({100.0 * count / max(len(best), 1):.0f} %)"
    return f"; at {share} the map names no scheme" if count else ""


def _tell_range(sizes: pd.Series[float]) -> str:
    return f"motion of {sizes.min():.2g} to {sizes.max():.2g} m"


def _tell_seas(bare: pd.DataFrame, column: str) -> str:
    """Say for each peak period from which wave height on the scheme of the highest sea is best."""
    start = "Without blades and with the soil as described,"
    beyond = _tell_unnamed(bare[column], "seas")
    bare = bare[bare[column] != UNNAMED]
    if bare.empty:
        return f"{start} no sea lies where the map names a scheme."
    highest = str(bare.sort_values("amplitude")[column].iloc[-1])
    least: dict[float, list[float]] = {}  # wave height -> peak periods
    lower: set[str] = set()
    for tp, seas in bare.groupby("tp"):
        others = seas[seas[column] != highest]
        higher = seas["hs"] > (others["hs"].max() if len(others) else 0.0)
        lower |= {str(name) for name in others[column]}
        hs = float(seas.loc[higher, "hs"].min()) if higher.any() else np.inf
        least.setdefault(hs, []).append(float(str(tp)))
    parts = ", ".join(
        f"{hs:g} m at Tp {_tell_periods(periods)} s"
        for hs, periods in least.items()
        if np.isfinite(hs)
    )
    never = f", in none at Tp {_tell_periods(least[np.inf])} s" if np.inf in least else ""
    rest = f"; in lower seas {' or '.join(sorted(lower))}" if lower else ""
    return f"{start} {highest} is best in seas from Hs {parts} on{never}{rest}{beyond}."


def _tell_periods(periods: Sequence[float]) -> str:
    first, last = periods[0], periods[-1]
    return f"{first:g}" if first == last else f"{first:g} to {last:g}"
