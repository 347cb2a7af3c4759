"""Makes an xarray Dataset of a run: all values with named dimensions, units and provenance."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from owtsweep._version import __version__
from owtsweep.config import dump
from owtsweep.errors import InputError, require
from owtsweep.results.contents import Contents
from owtsweep.sweep.gather import Results
from owtsweep.sweep.study import Engine, Study

if TYPE_CHECKING:
    import xarray


def make_dataset(
    study: Study, engine: Engine, results: Mapping[str, Results], metadata: Mapping[str, str]
) -> xarray.Dataset:
    """Return the values of a run, as `owtsweep.sweep.runs.Run.dataset` says.

    results: the results by tuning.
    metadata: Name -> text, for the attributes.
    """
    require(
        find_spec("xarray") is not None,
        "dataset: xarray is not installed; use pip install 'owtsweep[xarray]'",
    )
    import xarray

    parts = []
    for tuning, result in results.items():
        contents = engine.contents(result.config, result.tables, result.rows)
        if contents is None:
            raise InputError(
                f"dataset: the rows of the study {study.name} are no map; read them by cases()"
            )
        part = _make_part(contents)
        parts.append(part.expand_dims(tuning=[tuning]) if tuning else part)
    whole = parts[0] if "" in results else xarray.concat(parts, "tuning", join="outer")
    config = next(iter(results.values())).config
    origin = {"study": study.name, "owtsweep": __version__, "config": dump(config), **metadata}
    return whole.assign_attrs(origin)


def _make_part(contents: Contents) -> xarray.Dataset:
    import xarray

    cube = contents.cube
    shape = [len(cube.schemes), *map(len, cube.levels)]
    values = np.full((*shape, len(cube.measures), len(cube.windows), len(cube.replicates)), np.nan)
    for i in range(len(cube.schemes)):
        for place in cube.outer_places():
            values[(i, *place)] = cube.values(i, place)
    dimensions = ("scheme", *cube.names, "window", "replicate")
    variables = {}
    for number, measure in enumerate(cube.measures):
        criterion = contents.criteria.get(measure)
        about = {} if criterion is None else {
            "long_name": criterion.title, "error_unit": criterion.unit, "holds": criterion.values,
        }  # fmt: skip
        variables[measure] = (dimensions, values[..., number, :, :], about)
    coordinates = {
        one.name: (one.name, levels, {"long_name": one.label, "units": one.unit})
        for one, levels in zip(cube.conditions, cube.levels, strict=True)
    }
    labels = {
        "scheme": list(cube.schemes), "window": list(cube.windows),
        "replicate": list(cube.replicates),
    }  # fmt: skip
    return xarray.Dataset(variables, coordinates | labels)
