"""Computes the errors of a study's schemes over the values of one key, from ordinary records.

Records are paired: record 3 has the same random numbers at every value, and for every scheme.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.config import changed, require
from owtsweep.io.terminal import tell_step
from owtsweep.results.conditions import Condition, Value, show_value
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.status import FAILED
from owtsweep.statistics.contrasts import gap, ratio
from owtsweep.statistics.inference import mean_and_error, t_quantile
from owtsweep.studies.base.contest import WINDOW, AnyContest, list_origin
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.base.tables import find_latencies, list_competing, make_cube
from owtsweep.studies.base.varying.errors import Errors
from owtsweep.studies.base.varying.sentences import differ, find_ends, find_least
from owtsweep.sweep.study import Study

#: Records of a cell, unless the user says how many.
RECORDS = 8
#: Most cells: each has a panel and a table of its own.
MOST_CELLS = 6
#: Where the cases are kept, below the user's folder of results, for the next question.
FOLDER = "vary-cases"


def list_defaults(contest: AnyContest, config: ContestConfig) -> list[str]:
    """Return the overrides of `vary`: the cell in the middle of the map, and few records.

    A fixed number of records in the configuration is kept.
    """
    middle = [
        f"grid.{axis}=[{values[len(values) // 2]}]"
        for axis, values in contest.get_grid(config).items()
        if len(values) > 1
    ]
    return [*middle, *([f"grid.replicates={RECORDS}"] if config.grid.decides else [])]


def check(contest: AnyContest, along: Condition, configs: Mapping[Value, ContestConfig]) -> None:
    """Check that the errors can be shown in one figure.

    Raise `InputError` if the configurations ask for other cells, schemes or criteria than the
    first, or for cells whose number of records is open.
    """
    one = next(iter(configs.values()))
    for config in configs.values():
        require(
            not config.grid.decides,
            "grid.replicates: `vary` compares the same records at all values; give their number, "
            f"e.g. grid.replicates={RECORDS}",
        )
        require(
            _find_kept(contest, along, config) == _find_kept(contest, along, one),
            f"{along.label}: its values differ in grid, schemes or criterion, which `vary` needs "
            "to be the same; set those keys by overrides of their own",
        )
    cells = len(_list_cells(contest, along, one))
    axes = " ".join(f"grid.{axis}=[{values[0]}]" for axis, values in contest.get_grid(one).items())
    require(
        cells <= MOST_CELLS,
        f"grid: {cells} cells are too many for a figure; give at most {MOST_CELLS}, e.g. {axes}",
    )


def _find_kept(contest: AnyContest, along: Condition, config: ContestConfig) -> object:
    grid = _find_grid(contest, along, config)
    return grid, config.grid.replicates, config.schemes, config.criterion


def _find_grid(
    contest: AnyContest, along: Condition, config: ContestConfig
) -> dict[str, Sequence[Any]]:
    """Return axis -> its values, for the axes of the map but the one that is varied."""
    grid = contest.get_grid(config)
    return {axis: values for axis, values in grid.items() if along.label != f"grid.{axis}"}


def _list_cells(
    contest: AnyContest, along: Condition, config: ContestConfig
) -> list[dict[str, Value]]:
    """Return the cells of a map as axis -> value, without the axis that is varied."""
    grid = _find_grid(contest, along, config)
    return [dict(zip(grid, cell, strict=True)) for cell in product(*map(sorted, grid.values()))]


class _Values(NamedTuple):
    """The errors by a criterion, in the shape of those of `Errors`.

    judged: what is judged of each record, shape (schemes, values, cells, records).
    """

    judged: Array
    error: Array
    low: Array
    high: Array


def compute(
    study: Study, contest: AnyContest, along: Condition, configs: Mapping[Value, ContestConfig]
) -> Errors:
    """Run the cases of each configuration that are not kept, and return the schemes' errors.

    `check` has passed the configurations. Raise `InputError` if no case of a value has succeeded.
    """
    one = next(iter(configs.values()))
    rows: dict[Value, pd.DataFrame] = {}
    for number, (value, config) in enumerate(configs.items(), 1):
        place = f"{along.label}={show_value(value)}"
        tell_step(f"value {number} of {len(configs)}: {place}")
        rows[value] = _run(study, config, place)
    schemes, apart = _split(one, [*rows.values()])
    names = [*schemes, *apart]
    cubes = [make_cube(contest, config, rows[v], names) for v, config in configs.items()]
    cells = _list_cells(contest, along, one)
    measured = {measure for cube in cubes for measure in cube.measures}
    by_criterion = {
        name: _gather(cubes, names, cells, name, criterion, one.grid.first)
        for name, criterion in contest.criteria.items()
        if name in measured
    }
    require(
        one.criterion in by_criterion,
        f"criterion: no record has a value of {one.criterion}; choose another",
    )
    criterion, found = contest.criteria[one.criterion], by_criterion[one.criterion]
    best = _find_best(found, len(schemes))
    conditions = {c.name: c for c in contest.find_conditions(one)}
    errors = Errors(
        along=along,
        values=tuple(configs),
        schemes=tuple(schemes),
        apart=tuple(apart),
        cells=tuple(
            ", ".join(f"{conditions[axis].label} {conditions[axis].show(at)}" for axis, at in cell)
            for cell in map(dict.items, cells)
        ),
        title=criterion.title,
        unit=criterion.unit,
        error=found.error,
        best=best,
        best_scheme=best[: len(schemes)],
        interval=(found.low, found.high),
        facts=_list_common_facts(contest, [*configs.values()]),
        notes=tuple(_list_notes(along, apart, rows, cubes)),
        footnotes=("Vertical lines: 95 % intervals of each mean by itself.",),
        table=_make_table([*configs], names, cells, by_criterion),
    )
    return replace(errors, further=tuple(_compare_ends(errors, found.judged, criterion)))


def _run(study: Study, config: ContestConfig, place: str) -> pd.DataFrame:
    """Run what is not kept of a configuration; return the rows of all its cases."""
    from owtsweep.sweep.progress import make_progress
    from owtsweep.sweep.run import sweep

    outcome = sweep(study, keep_cases(config), progress=make_progress())
    reason = outcome.failed[0].reason if outcome.failed else "no scheme can work there"
    require(bool(outcome.results), f"{place}: no case has succeeded: {reason}")
    return outcome.run.cases()


def keep_cases(config: ContestConfig) -> ContestConfig:
    """Return the configuration of the run whose folder keeps the cases of a value."""
    return changed(config, results=str(Path(config.results) / FOLDER), name=None)


def _split(config: ContestConfig, rows: Sequence[pd.DataFrame]) -> tuple[list[str], list[str]]:
    """Return the schemes in the contest, and those that are not because their estimates wait."""
    names = list_names(config.schemes)
    competing = [{*list_competing(config, each)} for each in rows]
    schemes = [name for name in names if all(name in each for each in competing)] or names
    return schemes, [name for name in names if name not in schemes]


def _gather(
    cubes: Sequence[Cube],
    names: Sequence[str],
    cells: Sequence[Mapping[str, Value]],
    measure: str,
    criterion: Criterion,
    records: int,
) -> _Values:
    """Return the errors by a criterion; `cubes` have the values at each value of the key."""
    every = pd.MultiIndex.from_tuples([(name, *c.values()) for name in names for c in cells])
    of_values = []
    for cube in cubes:
        wide = cube.widen(measure, WINDOW)
        wide = wide.droplevel([name for name in cube.names if name not in cells[0]])
        filled = wide.reindex(index=every, columns=range(records))
        of_values.append(filled.to_numpy(dtype=float).reshape(len(names), len(cells), records))
    judged = criterion.judge(np.stack(of_values, axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        mean, error, n = mean_and_error(judged)
        reach = t_quantile(n - 1) * error
    low = criterion.express(np.maximum(mean - reach, 0.0))  # no error is negative
    return _Values(judged, criterion.express(mean), low, criterion.express(mean + reach))


def _find_best(found: _Values, count: int) -> NDArray[np.bool_]:
    """Return which of the first `count` schemes are best, or not told apart from the best.

    A scheme is told apart if the paired 95 % interval of its difference from the best lies above 0.
    """
    best = np.zeros(found.error.shape, dtype=bool)
    for v, c in np.ndindex(found.error.shape[1:]):
        errors = found.error[:count, v, c]
        if not np.isfinite(errors).any():
            continue
        least = int(np.nanargmin(errors))
        apart = gap(found.judged[:count, v, c] - found.judged[least, v, c]).low > 0.0
        best[:count, v, c] = np.isfinite(errors) & ~apart
    return best


def _compare_ends(errors: Errors, judged: Array, criterion: Criterion) -> Iterator[tuple[str, ...]]:
    """Yield for each cell a sentence on the change between two values, over paired records."""
    least = find_least(errors)
    for cell in range(len(errors.cells)):
        if np.isnan(least[:, cell]).any():
            yield ()  # the sentence before this one says so
            continue
        first, last = find_ends(errors, least[:, cell])
        best = [
            int(np.nanargmin(errors.error[: len(errors.schemes), v, cell])) for v in (first, last)
        ]
        pair = [judged[s, v, cell] for s, v in zip(best, (first, last), strict=True)]
        change = [float(each) for each in ratio(*pair, paired=True)[:3]]
        if criterion.squared:
            change = [each**0.5 for each in change]
        if not np.isfinite(change).all() or not differ(*least[[first, last], cell]):
            yield ()
            continue
        factor, low, high = (f"{each:.3g}" for each in change)
        yield (
            f"That is a factor of {factor} ({low} to {high} at 95 %, "
            f"{judged.shape[-1]} paired records).",
        )


def _list_common_facts(contest: AnyContest, configs: Sequence[ContestConfig]) -> tuple[str, ...]:
    listed = [list_origin(contest, config) for config in configs]
    return tuple(
        f"{name}: {text}"
        for name, text in listed[0].items()
        if all(each[name] == text for each in listed)
    )


def _list_notes(
    along: Condition,
    apart: Sequence[str],
    rows: Mapping[Value, pd.DataFrame],
    cubes: Sequence[Cube],
) -> Iterator[str]:
    """Yield sentences on schemes that wait, cannot work or have failed."""
    latencies = find_latencies(next(iter(rows.values())))
    if apart:
        waiting = ", ".join(f"{name} ({latencies[name]:.3g} s)" for name in apart)
        yield f"Not in the contest, because its estimates wait: {waiting}."
    for (value, of_value), cube in zip(rows.items(), cubes, strict=True):
        unable = sorted({*cube.unable["scheme"].astype(str)})
        if unable:
            yield f"Unable to work at {along.show(value)}: {', '.join(unable)}."
        failed = of_value["status"] == FAILED
        if failed.any():
            yield f"Failed at {along.show(value)}: {int(failed.sum())} cases, which do not count."


def _make_table(
    values: Sequence[Value],
    names: Sequence[str],
    cells: Sequence[Mapping[str, Value]],
    by_criterion: Mapping[str, _Values],
) -> pd.DataFrame:
    """Make the table vary.csv: a row per value, scheme, cell and criterion."""
    places = product(enumerate(values), enumerate(names), enumerate(cells), by_criterion.items())
    return pd.DataFrame(
        {
            "value": value,
            "scheme": name,
            **cell,
            "criterion": criterion,
            "error": found.error[s, v, c],
            "ci_low": found.low[s, v, c],
            "ci_high": found.high[s, v, c],
            "n": int(np.isfinite(found.judged[s, v, c]).sum()),
        }
        for (v, value), (s, name), (c, cell), (criterion, found) in places
    )
