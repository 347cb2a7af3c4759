"""Runs the schemes of a run on its record 0 once more, and keeps 40 s of truth and estimates.

A sweep stores errors alone. For its page, each cell's record is made again, and what the schemes
say of one quantity is kept from the settling time on. Where one run serves all amplitudes, the
least and the largest one are run: the page computes the others, because these schemes are linear.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.io.reading import read_json
from owtsweep.io.steps import tell_step
from owtsweep.results.conditions import Value
from owtsweep.results.contents import Contents
from owtsweep.sweep.study import Study, blame

if TYPE_CHECKING:
    from owtsweep.config import AnyConfig

STRETCHES = "stretches.json"
#: Length of a stretch, s, and the most samples of a second that are kept.
SECONDS, RATE = 40.0, 10.0
#: Most bytes of a stored file.
MOST_BYTES = 50_000_000
#: Full scale of a number of 16 bits.
_FULL = 32767


def make_stretches(study: Study, config: AnyConfig, contents: Contents) -> dict[str, object]:
    """Run the schemes on record 0 of each cell, and return 40 s of each as plain JSON data.

    config: the configuration, of one tuning.
    Returns: "label", and "cells": `at` (index of the value of each condition), `start` and `step`
        (s), and for truth and each scheme's error a name, a scale and numbers of 16 bits.
    Raises InputError if the study has no records to show, or a record cannot be made.
    """
    from joblib import Parallel, cpu_count, delayed

    if study.stretched is None:
        raise InputError(f"--stretches: the study {study.name} has no record to show")
    quantity, component, label = study.stretched
    cube = contents.cube
    levels = [list(enumerate(values)) for values in cube.levels]
    if cube.products is not None and cube.direct is None:
        levels[-1] = [levels[-1][0], levels[-1][-1]] if len(levels[-1]) > 1 else levels[-1]
    places: list[list[tuple[int, Value]]] = [[]]
    for values in levels:
        places = [[*place, value] for place in places for value in values]
    jobs = [
        (
            [i for i, _ in place],
            {n: value for n, (_, value) in zip(cube.names, place, strict=True)},
        )
        for place in places
    ]
    run = delayed(_run_cell)
    found = Parallel(n_jobs=min(cpu_count(), len(jobs)), return_as="generator")(
        run(study, config, at, cell, quantity, component) for at, cell in jobs
    )
    cells = []
    for number, cell in enumerate(found, start=1):
        tell_step(f"record {number} of {len(jobs)}")
        cells.append(cell)
    return {"label": label, "cells": cells}


def _run_cell(
    study: Study,
    config: AnyConfig,
    at: Sequence[int],
    cell: Mapping[str, Value],
    quantity: str,
    component: int,
) -> dict[str, object]:
    grid = changed(config.grid, **{name: [value] for name, value in cell.items()})
    with blame(study):
        record = study.estimate(changed(config, grid=grid), 0)
    step = float(record.time[1] - record.time[0])
    every = max(round(1.0 / (RATE * step)), 1)
    first = min(record.settled, max(len(record.time) - round(SECONDS / step), 0))
    part = slice(first, first + round(SECONDS / step) + 1, every)
    truth = np.asarray(record.truth[quantity])[part, component]
    series = [_pack("", truth)]
    for name, estimates in record.estimates.items():
        if quantity in estimates:
            error = np.asarray(estimates[quantity])[part, component] - truth
            if np.isfinite(error).all():
                series.append(_pack(name, error))
    time = float(record.time[first])
    return {"at": list(at), "start": time, "step": every * step, "series": series}


def _pack(name: str, values: Array) -> list[object]:
    """Return name ("" for the truth), scale and numbers of 16 bits."""
    scale = float(np.abs(values).max(initial=0.0)) / _FULL or 1.0
    numbers = np.round(values / scale).astype("<i2")
    return [name, scale, base64.b64encode(numbers.tobytes()).decode()]


def dump_stretches(stretches: Mapping[str, object]) -> str:
    """Return the text of the file that keeps stretches by tuning."""
    return json.dumps(stretches) + "\n"


def read_stretches(place: Path) -> dict[str, object]:
    """Return what is kept of a run, by tuning; {} if nothing is.

    Raises InputError if the file cannot be read.
    """
    path = place / STRETCHES
    if not path.is_file():
        return {}
    kept = read_json(path, MOST_BYTES)
    if not isinstance(kept, dict):
        raise InputError(f"{path}: this holds no stretches; delete it")
    return kept
