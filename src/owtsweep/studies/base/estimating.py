"""Shows one record of a declared study: motion, measurements and the schemes' estimates."""

from __future__ import annotations

from owtsweep.evaluation.estimate import EstimatedRecord
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.base.axes import list_cells
from owtsweep.studies.base.blocks import Readied, Records, find_ignored
from owtsweep.studies.base.contest import ContestConfig
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.base.declaration import AnyDeclaration, Stated


def estimate_record(
    declaration: AnyDeclaration, config: ContestConfig, replicate: int
) -> EstimatedRecord:
    """Make a record, run all schemes on it, and return all of it.

    Raises
    ------
    InputError
        If the grid has several cells, or the record cannot be made.
    """
    declaration.require(config)
    axes = declaration.contest.axes
    grid = {axis: values for axis in axes if (values := getattr(config.grid, axis)) is not None}
    conditions = find_only_cell(grid)
    declaration.warn(config)
    (cell,) = list_cells(axes, config.grid)
    made = Records(declaration, config, [replicate])
    stated: dict[str, Stated] = {}
    failures = {}
    for scheme in declaration.schemes.resolve_all(config.schemes):
        ignored = find_ignored(declaration, scheme)
        told = {axis: value for axis, value in cell.items() if axis not in ignored}
        ((record, parts),) = made.take(config, told)
        try:
            estimates = {name: Readied(scheme).run(part) for name, part in parts.items()}
        except Unable as reason:
            failures[scheme.name] = str(reason)
            continue
        stated[scheme.name] = declaration.state(record, estimates)
    shown = declaration.show(config, record)
    return EstimatedRecord(
        study=config.study,
        tuning=config.tuning_name,
        conditions=conditions,
        replicate=replicate,
        settled=config.record.settled,
        time=shown.time,
        truth=shown.truth,
        measurements=shown.measurements,
        estimates={name: given.estimates for name, given in stated.items()},
        covariances={name: given.covariances for name, given in stated.items()},
        waits={name: given.wait for name, given in stated.items()},
        units=shown.units,
        failures=failures,
        at_rest=shown.at_rest,
    )
