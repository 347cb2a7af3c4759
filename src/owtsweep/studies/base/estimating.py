"""Shows one record of a declared study: motion, measurements and the schemes' estimates."""

from __future__ import annotations

from owtsweep.config import AnyConfig
from owtsweep.errors import InputError
from owtsweep.evaluation.estimate import EstimatedRecord
from owtsweep.results.conditions import find_only_cell
from owtsweep.studies.base.blocks import Readied, Records, explain, find_ignored
from owtsweep.studies.base.declaration import AnyDeclaration, Stated


def estimate_record(
    declaration: AnyDeclaration, config: AnyConfig, replicate: int
) -> EstimatedRecord:
    """Make a record, run all schemes on it, and return all of it.

    Raise `InputError` if the grid has several cells, or the record cannot be made.
    """
    declaration.require(config)
    values = declaration.axes.get_values(config)
    conditions = find_only_cell(
        {axis: listed for axis, listed in values.items() if listed is not None},
        declaration.axes.section,
    )
    declaration.warn(config)
    (cell,) = declaration.axes.list_cells(config)
    made = Records(declaration, config, [replicate])
    stated: dict[str, Stated] = {}
    failures = {}
    for scheme in declaration.schemes.choose(config):
        ignored = find_ignored(declaration, scheme)
        known = {axis: value for axis, value in cell.items() if axis not in ignored}
        ((record, parts),) = made.take(config, known)
        readied = Readied(declaration, scheme)
        try:
            estimates = {name: readied.run(part) for name, part in parts.items()}
        except (KeyboardInterrupt, InputError):
            raise
        except BaseException as error:  # a user's scheme may raise anything
            failures[scheme.name] = explain(error).reason
            continue
        stated[scheme.name] = declaration.state(record, estimates)
    return EstimatedRecord(
        study=config.study,
        tuning=config.tuning_name,
        conditions=conditions,
        replicate=replicate,
        estimates={name: given.estimates for name, given in stated.items()},
        covariances={name: given.covariances for name, given in stated.items()},
        latencies={name: given.wait for name, given in stated.items()},
        failures=failures,
        **declaration.show(config, cell, record)._asdict(),
    )
