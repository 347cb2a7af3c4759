"""Draw the envelope of a structure over a run's map, and say which scheme is best in which sea.

Ren et al. (2019) draw "the normal envelope of oscillation amplitude and natural period", the yellow
area of figure 18. Here it is computed: the region that holds 95 % of the points of a structure in
the seas of section 2.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import AnyConfig
from owtsweep.errors import InputError, require
from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.motion.envelope import SHARE, compute_points, find_region, list_seas
from owtsweep.streams import stream
from owtsweep.structures import Structure
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import find_winners
from owtsweep.studies.hub.figures import maps_by_tuning
from owtsweep.studies.hub.worlds import require_spectrum
from owtsweep.sweep.gather import Results
from owtsweep.sweep.runs import Run

NAME = "envelope"
#: What stands for the best scheme of a point where the map names none: the point lies outside the
#: map, or in a cell without a result.
UNNAMED = ""
#: Value of the key `normalise` -> the column of the points that the run's amplitudes are.
SIZES = {"peak": "amplitude", "rms": "rms"}


def save_envelope(run: Run, structure: Structure, folder: Path) -> tuple[list[Path], list[str]]:
    """Write the map of a run with a structure's envelope, and the table of the sea states behind.

    The files are envelope.png, envelope.svg and envelope.csv. Return their paths, and for each
    tuning a sentence or two on the best scheme in which sea. The sea states have the seed and the
    length of the run's records.

    run: a finished run of the hub study, over natural period and amplitude.
    Raises InputError if the run is of another study, has no results, has a map without area, or has
    records too short for waves; or if the structure does not stand in water.
    """
    if run.study.name != "hub":
        raise InputError(
            f"{run.folder}: a run of the study {run.study.name!r} has no map of natural period and "
            "amplitude; use a run of the study hub"
        )
    config: AnyConfig = run.config
    require_spectrum(config, "the envelope on a map")
    draw = partial(stream, config.seed, "hub", (), 0)
    points = compute_points(structure, list_seas(), draw, duration=config.record.duration)
    results = {}
    for part in run.by_tuning().values():
        one: AnyConfig = part.config
        best = part.best_scheme()
        points[f"best_{one.tuning_name}"] = find_best(one, best, points)
        rows = best.iloc[:0]
        with suppress(InputError):  # a run whose cases are gone still has its map
            rows = part.cases()
        results[one.tuning_name] = Results(one, rows, {"best_scheme": best})
    size = SIZES[config.normalise]
    with style.context():
        figure = maps_by_tuning.draw(results, region=_make_region(points, structure, size))
        files = style.save(figure, folder, NAME, run.metadata() | {"structure": structure.name})
    table = write_table(folder, NAME, points)
    return [*files, table], [tell_best(points, tuning, size) for tuning in results]


def _make_region(points: pd.DataFrame, structure: Structure, size: str) -> maps_by_tuning.Region:
    """Return the region of a structure's points as it is drawn over a map, with its explanation.

    `size` is the column "amplitude" or "rms".
    """
    heights, periods = points["hs"], points["tp"]
    text = (
        f"Outlined: where the structure {structure.name} is, some {100.0 * SHARE:g} % of its "
        f"points around each natural period. Its {len(points)} points are sea states of Hs "
        f"{heights.min():g} to {heights.max():g} m and Tp {periods.min():g} to {periods.max():g} s "
        "that are no steeper than seas are found to be (Hs over wave length at most 1/15), "
        f"with 0 to {points['blades'].max()} blades and soils of several friction angles, all of "
        "the same weight."
    )
    sized = points.assign(amplitude=points[size])
    return maps_by_tuning.Region(*find_region(sized), f"envelope of {structure.name}", text)


def find_best(config: HubConfig, best: pd.DataFrame, points: pd.DataFrame) -> list[str]:
    """Return what a run's map names at each point: a scheme, or a baseline that has less error.

    A point belongs to the cell whose centre is nearest, with amplitudes on a logarithmic scale. It
    gets `UNNAMED` outside the map or in a cell without a result.

    config: the configuration of the run, of one tuning.
    best: the run's table best_scheme.
    points: the points, as `owtsweep.motion.envelope.compute_points` returns them.
    Raises InputError if the run has one natural period or one amplitude, so that its map has no
    area.
    """
    measures = config.measures
    cells = find_winners(config, best, measures.criterion, measures.window).table
    require(len(cells) > 0, "best_scheme: the run has no cell that its criterion and window judge")
    named = cells.pivot(index="natural_period", columns="amplitude", values="best").fillna(UNNAMED)
    across, upwards = named.index.to_numpy(dtype=float), named.columns.to_numpy(dtype=float)
    for name, values in (("natural_period", across), ("amplitude", upwards)):
        require(
            len(values) > 1,
            f"grid.{name}: the run has one value, so its map has no area for an envelope; give "
            "two or more",
        )
    columns = _find_cells(points["natural_period"].to_numpy(), across)
    lines = _find_cells(np.log(points[SIZES[config.normalise]].to_numpy()), np.log(upwards))
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
    best, sizes = points[f"best_{tuning}"], points[size].groupby(points[f"best_{tuning}"])
    ranges = {name: f"motion of {of.min():.2g} to {of.max():.2g} m" for name, of in sizes}
    shares = best[best != UNNAMED].value_counts() / len(best)
    if shares.empty:
        return f"Tuning {tuning}: the map names a scheme at none of the {len(best)} points."
    parts = [f"{name} in {100.0 * share:.0f} % ({ranges[name]})" for name, share in shares.items()]
    beyond = _tell_unnamed(best, "points")
    if beyond:
        beyond += f" ({ranges[UNNAMED]})"
    first = f"Tuning {tuning}: over all seas, blades and soils, best is {', '.join(parts)}{beyond}."
    bare = points[(points["blades"] == 0) & points["friction_angle"].isna()]
    return f"{first} {_tell_seas(bare, f'best_{tuning}')}"


def _tell_unnamed(best: pd.Series[str], what: str) -> str:
    """Say at how many of the points the map names no scheme; "" if it names one at each."""
    count = int((best == UNNAMED).sum())
    share = f"{count} of {len(best)} {what} ({100.0 * count / max(len(best), 1):.0f} %)"
    return f"; at {share} the map names no scheme" if count else ""


def _tell_seas(bare: pd.DataFrame, column: str) -> str:
    """Say for each peak period from which wave height on the scheme of the highest sea is best."""
    start = "Without blades and with the soil as described,"
    beyond = _tell_unnamed(bare[column], "seas")
    bare = bare[bare[column] != UNNAMED]
    if bare.empty:
        return f"{start} no sea lies where the map names a scheme."
    highest = str(bare.sort_values("amplitude")[column].iloc[-1])
    others = sorted({*bare[column]} - {highest})
    periods: dict[float, list[float]] = {}  # least wave height -> peak periods
    for tp, seas in bare.groupby("tp"):
        beaten = max(seas.loc[seas[column] != highest, "hs"], default=0.0)
        least = min(seas.loc[seas["hs"] > beaten, "hs"], default=np.inf)
        periods.setdefault(least, []).append(float(str(tp)))
    never = periods.pop(np.inf, [])
    parts = ", ".join(f"{hs:g} m at Tp {_tell_periods(of_hs)} s" for hs, of_hs in periods.items())
    text = f"{start} {highest} is best in seas from Hs {parts} on"
    text += f", in none at Tp {_tell_periods(never)} s" if never else ""
    text += f"; in lower seas {' or '.join(others)}" if others else ""
    return f"{text}{beyond}."


def _tell_periods(periods: Sequence[float]) -> str:
    first, last = periods[0], periods[-1]
    return f"{first:g}" if first == last else f"{first:g} to {last:g}"
