"""Makes the data of a page, as JSON: verdicts of all cells, and the statistics they rest on."""

from __future__ import annotations

import base64
import math
from array import array
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.palette import SchemeStyle, style_of
from owtsweep.report.static_map import choose_axes, get_grid
from owtsweep.report.statistics import MOST_RECORDS, Look, find_looks, gather_records, is_superposed
from owtsweep.results.contents import Contents
from owtsweep.statistics.inference import t_quantile

#: In maps of more cells, a page has the means alone, without intervals.
MOST_CELLS = 1000
#: Columns of best_scheme.csv that a page has, besides conditions and criterion.
COLUMNS = (
    "verdict", "best", "runner_up", "baseline", "left", "error_best", "error_low", "error_high",
    "error_runner_up", "error_baseline", "look", "n", "more",
)  # fmt: skip


def make_part(
    tuning: str, contents: Contents, *, exact: bool, details: object = None, help: str = ""
) -> dict[str, object]:
    """Return the data of one tuning: plain lists, texts and numbers.

    exact: whether the values are expected ones, and no samples of records.
    details: what `owtsweep.sweep.page` has kept of records, as JSON data.
    help: how to get details, where there are none.
    """
    cube, floats, grid = contents.cube, array("f"), get_grid(contents)
    names = [name for name in contents.criteria if name in cube.measures]
    means_only = exact or math.prod(len(levels) for levels in cube.levels) > MOST_CELLS
    looks: dict[str, dict[str, object]] = {name: {} for name in names}
    records: dict[str, dict[str, object]] = {name: {} for name in names}
    counts: set[int] = set()
    for name, window in product(names, cube.windows):
        values = gather_records(cube, name, contents.criteria[name], window)
        found = [find_looks(of_cell, means_only=means_only) for of_cell in values]
        looks[name][window] = [[_pack(look, floats) for look in of_cell] for of_cell in found]
        counts |= {look.records for of_cell in found for look in of_cell}
        if details is not None:
            shown = values[..., :MOST_RECORDS]
            records[name][window] = [_add(floats, shown), *shown.shape]
    plane = choose_axes(contents.conditions, grid)
    return {
        "tuning": tuning,
        "schemes": [
            {"name": name, "baseline": name in contents.baselines}
            | _draw_as(style_of(name, cube.schemes))
            for name in cube.schemes
        ],
        "criteria": [
            {"name": name, **_list_facts(contents.criteria[name], "title", "unit", "squared")}
            for name in names
        ],
        "windows": list(cube.windows),
        "window": contents.window,
        "conditions": [
            {**_list_facts(condition, "name", "label", "word", "unit", "scale"), "values": levels}
            for condition, levels in zip(cube.conditions, cube.levels, strict=True)
        ],
        "across": cube.names.index(plane.across.name),
        "upwards": cube.names.index(plane.upwards.name) if plane.upwards else -1,
        "further": [cube.names.index(name) for name in plane.list_off(contents.conditions)],
        "superposed": is_superposed(cube),
        "exact": exact,
        "cells": _list_cells(contents),
        "looks": looks,
        "floats": base64.b64encode(floats.tobytes()).decode(),
        "details": details,
        "records": None if details is None else records,
        "help": help,
        "t": {count: float(t_quantile(count - 1)) for count in sorted(counts) if count > 1},
    }


def _list_facts(thing: object, *names: str) -> dict[str, object]:
    return {name: getattr(thing, name) for name in names}


def _add(floats: array[float], *added: Array) -> int:
    """Add the numbers of arrays, in 32 bits; return the place of the first one."""
    place = len(floats)
    for each in added:
        floats.frombytes(each.astype("<f4").tobytes())
    return place


def _pack(look: Look, floats: array[float]) -> tuple[int, list[int], int, int]:
    """Return number of records, schemes, place of the numbers, and rows of the factor."""
    return look.records, look.schemes, _add(floats, look.mean, look.factor), len(look.factor)


def _draw_as(style: SchemeStyle) -> dict[str, str]:
    dash = "" if style.line == "-" else " ".join(str(2 * length) for length in style.line[1])
    return {"color": style.color, "dash": dash}


def _list_cells(contents: Contents) -> dict[str, list[Any]]:
    """Return columns of the cells: `at`, indices of the conditions' values, criterion and more."""
    cube, best = contents.cube, contents.cells
    levels = zip(cube.names, cube.levels, strict=True)
    at = np.transpose([best[name].map(each.index) for name, each in levels]).tolist()
    columns = {name: _as_plain(best[name].tolist()) for name in COLUMNS if name in best}
    return {"at": at, "criterion": best["criterion"].tolist(), **columns}


def _as_plain(values: Sequence[object]) -> list[object]:
    return [
        None if isinstance(value, float) and not math.isfinite(value) else value for value in values
    ]
