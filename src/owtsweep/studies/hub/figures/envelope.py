"""Draw the envelope of a structure over a run's map of best schemes, like figure 18's yellow area.

Ren et al. (2019) draw "the normal envelope of oscillation amplitude and natural period". Here it
is computed: the region that holds 95 % of the points of a structure in the seas of section 2.1.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pandas as pd

from owtsweep.config import AnyConfig
from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.motion.envelope import SHARE, find_region
from owtsweep.structures import Structure
from owtsweep.studies.hub.conditions import require_spectrum
from owtsweep.studies.hub.envelope import SIZES, compute_envelope, find_best, tell_best
from owtsweep.studies.hub.figures import maps_by_tuning
from owtsweep.sweep.gather import Results
from owtsweep.sweep.runs import Run

NAME = "envelope"


def save_envelope(run: Run, structure: Structure, folder: Path) -> tuple[list[Path], list[str]]:
    """Write the map of a run with a structure's envelope, and the table of the sea states behind.

    The files are envelope.png, envelope.svg and envelope.csv. Return their paths, and for each
    tuning a sentence or two on the best scheme in which sea.

    run: a finished run of the hub study, over natural period and amplitude.
    Raises InputError if the run is of another study, has no results, or has a map without area; or
    if the structure does not stand in water.
    """
    if run.study.name != "hub":
        raise InputError(
            f"{run.folder}: a run of the study {run.study.name!r} has no map of natural period and "
            "amplitude; use a run of the study hub"
        )
    config: AnyConfig = run.config
    require_spectrum(config, "the envelope on a map")
    points = compute_envelope(config, structure)
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
        figure = maps_by_tuning.draw(results, region=make_region(points, structure, size))
        files = style.save(figure, folder, NAME, run.metadata() | {"structure": structure.name})
    table = write_table(folder, NAME, points)
    return [*files, table], [tell_best(points, tuning, size) for tuning in results]


def make_region(
    points: pd.DataFrame, structure: Structure, size: str = "amplitude"
) -> maps_by_tuning.Region:
    """Return the region of a structure's points as it is drawn over a map, with its explanation.

    The points are those of `compute_envelope`; `size` is the column "amplitude" or "rms".
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
