"""Computes what a page shows on request: 40 s of a record in each cell, and error spectra.

A sweep stores errors alone. For its page, record 0 of each cell is made again, and what the schemes
say of one quantity is kept from the middle of the judged part on, because a scheme that learns the
sea starts like another one. Where one run serves all amplitudes, the
least and the largest one are run: the page computes the others, because these schemes are linear.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pydantic import FiniteFloat

from owtsweep.arrays import Array
from owtsweep.config import AnyConfig, changed
from owtsweep.errors import InputError
from owtsweep.io.reading import read_as
from owtsweep.io.steps import tell_step
from owtsweep.results.conditions import Value
from owtsweep.results.contents import Contents
from owtsweep.sweep.asked import DETAILS
from owtsweep.sweep.study import Study, blame

#: Length of a stretch, s, and the most samples of a second that are kept.
SECONDS, RATE = 40.0, 10.0
#: Most bytes of a stored file.
MOST_BYTES = 50_000_000
#: Full scale of a number of 16 bits.
_FULL = 32767


def make_details(study: Study, config: AnyConfig, contents: Contents) -> dict[str, object]:
    """Run the schemes on record 0 of each cell, and return 40 s of each as plain JSON data.

    With them go the error spectra of the study, if it has any.

    config: the configuration, of one tuning.
    Returns: "label", and "cells": `at` (index of the value of each condition), `start` and `step`
        (s), and for truth and each scheme's error a name, a scale and numbers of 16 bits.
        "spectra": lines of scheme, measure, frequencies and errors; may be empty.
    Raises InputError if the study has no records to show, or a record cannot be made.
    """
    from joblib import Parallel, cpu_count, delayed

    if study.stretched is None:
        raise InputError(f"--details: the study {study.name} has no record to show")
    quantity, component, label = study.stretched
    cube = contents.cube
    levels = [list(enumerate(values)) for values in cube.levels]
    if cube.products is not None and cube.direct is None:
        levels[-1] = [levels[-1][0], levels[-1][-1]] if len(levels[-1]) > 1 else levels[-1]
    places = [dict(zip(cube.names, place, strict=True)) for place in product(*levels)]
    run = delayed(_run_cell)
    found = Parallel(n_jobs=min(cpu_count(), len(places)), return_as="generator")(
        run(study, config, place, quantity, component) for place in places
    )
    cells = []
    for number, cell in enumerate(found, start=1):
        tell_step(f"record {number} of {len(places)}")
        cells.append(cell)
    with blame(study):
        spectra = study.engine(config).spectra(config)
    return {"label": label, "cells": cells, "spectra": _list_spectra(spectra)}


def _list_spectra(table: pd.DataFrame | None) -> list[list[object]]:
    if table is None:
        return []
    return [
        [str(name), measure, _round(of_scheme["frequency"]), _round(of_scheme[measure])]
        for name, of_scheme in table.groupby("scheme", sort=False)
        for measure in table.columns[2:]
    ]


def _round(values: pd.Series[float]) -> list[float]:
    return [float(f"{value:.5g}") for value in values]


def _run_cell(
    study: Study,
    config: AnyConfig,
    place: Mapping[str, tuple[int, Value]],
    quantity: str,
    component: int,
) -> dict[str, object]:
    """Run record 0 of a cell; `place` has the index and the value of each condition."""
    grid = changed(config.grid, **{name: [value] for name, (_, value) in place.items()})
    with blame(study):
        record = study.estimate(changed(config, grid=grid), 0)
    step = float(record.time[1] - record.time[0])
    every = max(round(1.0 / (RATE * step)), 1)
    middle = (record.settled + len(record.time)) // 2
    first = min(middle, max(len(record.time) - round(SECONDS / step), 0))
    part = slice(first, first + round(SECONDS / step) + 1, every)
    truth = np.asarray(record.truth[quantity])[part, component]
    series = [pack("", truth)]
    for name, estimates in record.estimates.items():
        if quantity in estimates:
            error = np.asarray(estimates[quantity])[part, component] - truth
            if np.isfinite(error).all():
                series.append(pack(name, error))
    at, time = [index for index, _ in place.values()], float(record.time[first])
    return {"at": at, "start": time, "step": every * step, "series": series}


def pack(name: str, values: Array) -> list[object]:
    """Return name ("" for the truth), scale and numbers of 16 bits."""
    scale = float(np.abs(values).max(initial=0.0)) / _FULL or 1.0
    numbers = np.round(values / scale).astype("<i2")
    return [name, scale, base64.b64encode(numbers.tobytes()).decode()]


def dump_details(details: Mapping[str, object]) -> str:
    """Return the text of the file that keeps details by tuning."""
    return json.dumps(details) + "\n"


@dataclass
class _Cell:
    at: list[int]
    start: FiniteFloat
    step: FiniteFloat
    series: list[tuple[str, FiniteFloat, str]]


@dataclass
class _Details:
    label: str
    cells: list[_Cell]
    spectra: list[tuple[str, str, list[FiniteFloat], list[FiniteFloat]]]


def read_details(place: Path) -> dict[str, Any]:
    """Return what is kept of a run, by tuning; {} if nothing is.

    Raises InputError if the file, which may be another person's, holds anything else.
    """
    path = place / DETAILS
    if not path.is_file():
        return {}
    refusal = "this holds no details of a run; delete it, or write it again by --details"
    kept = read_as(dict[str, _Details], path, MOST_BYTES, refusal)
    return {tuning: asdict(details) for tuning, details in kept.items()}
