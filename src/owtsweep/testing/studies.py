"""Checks that a study, e.g. a user's, keeps the contract in `owtsweep.sweep.study`.

    from owtsweep.testing import check_study

    def test_my_study():
        check_study(MyStudy())

If the study breaks the contract, the check raises `AssertionError`. Its message is one line that
names the broken part.
"""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from tempfile import TemporaryDirectory
from typing import Literal, get_args, get_origin

import pandas as pd
from pydantic.fields import FieldInfo
from rich.console import Console

from owtsweep.config import Config, Plain, Section, as_mapping, with_values
from owtsweep.config.grid import CONTEST_KEYS
from owtsweep.config.section import bare_type
from owtsweep.errors import InputError
from owtsweep.results.best_scheme import VERDICT_COLUMNS
from owtsweep.studies import compose
from owtsweep.sweep.plan import count_cases, make_plan, make_tasks
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import FAILED, OK, Study

#: Columns of the tables `summary` and `best_scheme`: those before and after the conditions.
SUMMARY = (("scheme",), ("measure", "window", "mean", "ci_low", "ci_high", "n"))
BEST_SCHEME = ((), VERDICT_COLUMNS)
#: Further columns of both tables, present if a scheme has no value in some cells of the grid.
SETBACK = ("status", "reason")
#: Keys that are not varied: `grid` and `schemes` only select blocks; the others have one value.
NOT_VARIED = frozenset({"grid", "schemes", "study", "config_version"})


def check_study(
    study: Study, config: Config | None = None, *, failing: Config | None = None
) -> None:
    """Run all checks on a study.

    Raise `AssertionError` if a check fails. The message is one line that names the study and the
    broken part of the contract.

    config: a small configuration of the study. It is run several times, and the runs are stored in
        the folder that its key `results` names. If None, the study's default configuration is run,
        and the runs are stored in a temporary folder.
    failing: a configuration with which some cases fail and others succeed. If None, the handling of
        failures is not checked.

    `owtsweep init study NAME` writes a study with a test that calls this function.

    >>> from owtsweep.studies import compose, get_study
    >>> config = compose([
    ...     "study=floater", "grid.delay=[0]", "grid.bias=[0.1]", "grid.replicates=2",
    ...     "schemes=[KF]", "record.duration=60", "compute.backend=threading", "results=checked",
    ... ])
    >>> check_study(get_study("floater"), config)  # says nothing where all is well
    """
    if config is None:
        with TemporaryDirectory() as folder:
            check_study(study, compose([f"study={study.name}", f"results={folder}"]))
        return
    check_plan(study, config)
    check_keys(study, config)
    run = check_run(study, config)
    check_rows(study, config, run.cases())
    check_tables(study, config, run.tables())
    check_blocks_alone(study, config)
    check_run(study, one_case(config))
    if failing is not None:
        check_failures(study, failing)


def check_plan(study: Study, config: Config) -> None:
    """Check that planning a configuration twice gives equal blocks, whatever the order of the grid.

    Raise `AssertionError` if two plans differ in the blocks' keys, or if reversing an axis of the
    grid changes the set of these keys.
    """
    keys = _keys(study, config)
    assert keys == _keys(study, config), f"{study.name}: two plans of one configuration differ"
    for name, other in reversed_grids(config):
        assert set(_keys(study, other)) == set(keys), (
            f"{study.name}: the blocks depend on the order of grid.{name}; a block's content holds "
            "its own condition, never the grid's list"
        )


def check_keys(study: Study, config: Config) -> list[str]:
    """Check that each configuration key changes blocks of the plan, unless the key is inert.

    Return the keys that were not checked, because the study accepted none of the values tried.
    Raise `AssertionError` if changing an inert key changes the blocks' hashes, or changing another
    does not.
    """
    keys = set(_keys(study, config))
    untried = []
    for name, changes_numbers, other in variations(study, config):
        if other is None:
            untried.append(name)
            continue
        same = set(_keys(study, other)) == keys
        if changes_numbers:
            assert not same, (
                f"{study.name}: {name} changes no block's content; put it there, or declare it "
                "among the configuration's `inert` keys"
            )
        else:
            assert same, f"{study.name}: {name} is declared inert, but changes keys"
    return untried


def check_run(study: Study, config: Config) -> Run:
    """Run a study twice; check that the second run computes nothing, and that results can be shown.

    Raise `AssertionError` if a case fails, if the second run computes a case, if the terminal shows
    nothing, or if no figure is drawn.
    """
    cases = count_cases(make_plan(study, config))
    first = sweep(study, config)
    reasons = [f"{failure.label}: {failure.reason}" for failure in first.failed]
    assert not reasons, f"{study.name}: cases of the small study fail: {'; '.join(reasons)}"
    again = sweep(study, config)
    assert (again.computed, again.reused) == (0, cases), (
        f"{study.name}: a second sweep computes {again.computed} of {cases} cases again"
    )
    run = first.run
    engine, shown = study.engine(config), StringIO()
    Console(file=shown).print(engine.terminal(config, run.tables()))
    assert shown.getvalue().strip(), f"{study.name}: the terminal shows nothing"
    files = [*run.draw(engine.overview(config)), *run.draw()]
    missing = [str(file) for file in files if not file.is_file()]
    assert files, f"{study.name}: nothing is drawn"
    assert not missing, f"{study.name}: drawings are named but not written: {', '.join(missing)}"
    return run


def check_rows(study: Study, config: Config, rows: pd.DataFrame) -> None:
    """Check that no row appears twice, and that each row that is not ok has a reason.

    `rows` are those of a run: the store refuses rows that lack a column, or have an unknown status.
    Raise `AssertionError` if two rows agree in all `sort_columns` of the engine, if a row with the
    status "ok" has a reason, or if another row has none.
    """
    identity = study.engine(config).sort_columns()
    repeated = rows[rows.duplicated(identity)]
    assert repeated.empty, (
        f"{study.name}: {len(repeated)} rows have the same {', '.join(identity)} as another; "
        "sort_columns must identify a row"
    )
    unexplained = (rows["status"] == OK) != (rows["reason"] == "")
    assert not unexplained.any(), f"{study.name}: a reason belongs to each row that is not ok"


def check_tables(study: Study, config: Config, tables: dict[str, pd.DataFrame]) -> None:
    """Check that a run has tables, and that `summary` and `best_scheme` have the required columns.

    Raise `AssertionError` if the run has no table, or if one of these two, which may be absent,
    begins with other columns.
    """
    assert tables, f"{study.name}: a run has no table"
    conditions = [condition.name for condition in study.conditions(config)]
    for name, (before, after) in (("summary", SUMMARY), ("best_scheme", BEST_SCHEME)):
        if name not in tables:
            continue
        columns = tuple(column for column in tables[name].columns if column not in SETBACK)
        expected = (*before, *conditions, *after)
        assert columns[: len(expected)] == expected, (
            f"{study.name}: {name} has the columns {', '.join(columns)}, not {', '.join(expected)}"
        )


def check_blocks_alone(study: Study, config: Config) -> None:
    """Check that each block gives the same rows whether it runs alone or together with its group.

    The first block of each group is not run alone. Raise `AssertionError` if a block gives other
    rows when it runs alone.
    """
    engine = study.engine(config)
    for task in make_tasks(make_plan(study, config)):
        blocks = list(task.values())
        together = {block.label: rows for block, rows in engine.run(config, blocks)}
        for block in blocks[1:]:
            ((_, alone),) = engine.run(config, [block])
            assert alone.equals(together[block.label]), (
                f"{study.name}: {block.label} has other rows when it runs alone"
            )


def check_failures(study: Study, config: Config) -> None:
    """Check that a failed case has a reason, and that other cases succeed in spite of it.

    Raise `AssertionError` if no case fails, if no case succeeds, or if a failed case has no reason.
    """
    outcome = sweep(study, config)
    rows = outcome.run.cases()
    failed = rows[rows["status"] == FAILED]
    assert len(failed), f"{study.name}: no case fails under the overrides `failing`"
    assert (rows["status"] == OK).any(), f"{study.name}: one failing case takes all others with it"
    assert (failed["reason"] != "").all(), f"{study.name}: a failed case has no reason"


def _keys(study: Study, config: Config) -> list[str]:
    return list(make_plan(study, config))


def variations(study: Study, config: Config) -> Iterator[tuple[str, bool, Config | None]]:
    """Yield the configuration with one key changed, for each key in turn except `NOT_VARIED`.

    Yield the dotted key, whether it may change numbers (is not inert), and the changed
    configuration, or None if the study accepts none of the values tried.
    """
    for name, field, value in _leaves(config):
        sections = {name[:end] for end, sign in enumerate(name) if sign == "."}
        if not {name, *sections} & NOT_VARIED:
            inert = bool({name, *sections} & config.inert)
            yield name, not inert, _vary(study, config, name, field, value)


def reversed_grids(config: Config) -> Iterator[tuple[str, Config]]:
    """Yield for each axis of the grid its name, and the configuration with the axis reversed."""
    for name, values in as_mapping(config)["grid"].items():
        if isinstance(values, list):
            yield name, with_values(config, {f"grid.{name}": values[::-1]})


def one_case(config: Config) -> Config:
    """Return the configuration of a run of one case, named "one-case".

    The case has the first value of each axis of the grid, one replicate and the first scheme.
    """
    plain = as_mapping(config)
    values: Plain = {"name": "one-case"}
    for name, item in plain["grid"].items():
        # None: an axis that may be left out, and is
        if item is not None and name not in CONTEST_KEYS:
            values[f"grid.{name}"] = item[:1] if isinstance(item, list) else 1
    if "schemes" in plain:
        values["schemes"] = plain["schemes"][:1]
    return with_values(config, values)


def _leaves(section: Section, prefix: str = "") -> Iterator[tuple[str, FieldInfo, object]]:
    """Yield dotted key, pydantic field and value of each key that is no section."""
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, Section):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", field, value


def _vary(
    study: Study, config: Config, name: str, field: FieldInfo, value: object
) -> Config | None:
    """Return the configuration with the first accepted other value of the key, or None."""
    for candidate in _candidates(field.annotation, value):
        if candidate == value:
            continue
        try:
            other = with_values(config, {name: candidate})
            other.check()
            study.check(other)
            study.check_outside(other)
        except InputError:
            continue
        return other
    return None


def _candidates(annotation: object, value: object) -> list[object]:
    """Return values to try for a key, perhaps also the present one; none if its type is unknown."""
    kind = bare_type(annotation)
    if get_origin(kind) is Literal:
        return list(get_args(kind))
    if value is None:
        options: dict[object, list[object]] = {str: ["other"], float: [1.0, 10.0], int: [1, 10]}
        return options.get(kind, [])
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int | float):
        more = [value + 1, value - 1, 2 * value, value / 2, 1.1 * value, 0.9 * value]
        return [int(item) if kind is int else item for item in more]
    if isinstance(value, str):
        return [f"{value}-other"]
    if isinstance(value, list) and value and all(isinstance(item, float) for item in value):
        return [[1.1 * item for item in value], [item + 0.1 for item in value]]
    return []
