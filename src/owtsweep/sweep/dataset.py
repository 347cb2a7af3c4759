"""Makes an xarray Dataset of a run: all values with named dimensions, units and provenance."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING

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
    cube = contents.cube
    axes = ["scheme", *cube.names, "window", "replicate"]
    labels = cube.schemes, *cube.levels, cube.windows, cube.replicates
    wide = cube.to_table().pivot(index=axes, columns="measure", values="value")
    every = {name: list(of_axis) for name, of_axis in zip(axes, labels, strict=True)}
    part: xarray.Dataset = wide.to_xarray().reindex(every)[list(cube.measures)]
    for measure in cube.measures:
        if criterion := contents.criteria.get(measure):
            about = {"long_name": criterion.title, "error_unit": criterion.unit}
            part[measure].attrs |= {**about, "holds": criterion.values}
    for condition in cube.conditions:
        part[condition.name].attrs |= {"long_name": condition.label, "units": condition.unit}
    return part
