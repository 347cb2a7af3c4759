"""Checks that a study, also a user's, keeps the contract of a study.

    def test_my_study():
        check_study(MyStudy())

If a study breaks the contract, the check raises `AssertionError` with one line that names the
broken part. The contract is in `owtsweep.sweep.study`.
"""

from __future__ import annotations

from io import StringIO
from tempfile import TemporaryDirectory

import pandas as pd
from rich.console import Console

from owtsweep.config import Config
from owtsweep.studies import compose
from owtsweep.sweep.plan import count_cases, make_plan, make_tasks
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import FAILED, OK, UNABLE, Study
from owtsweep.testing.variations import one_case, reversed_grids, variations

#: Columns of the tables that all studies have: those left and those right of the conditions'.
SUMMARY = (("scheme",), ("measure", "window", "mean", "ci_low", "ci_high", "n"))
BEST_SCHEME = (
    (),
    (
        "criterion", "window", "best", "runner_up", "mse_best", "mse_runner_up", "difference",
        "ci_low", "ci_high", "distinguishable",
    ),
)  # fmt: skip
#: Further columns of these tables, present if a scheme has no value in some cells of the grid.
SETBACK = ("status", "reason")


def check_study(
    study: Study, config: Config | None = None, *, failing: Config | None = None
) -> None:
    """Run all checks on a study.

    Parameters
    ----------
    study
        The study.
    config
        A small configuration of the study, which is run several times; runs are stored below the
        folder that its key `results` names. If None, the default configuration of the study is
        used, in a temporary folder.
    failing
        A configuration with which some cases fail and others do not. If None, failures are not
        checked.

    Raises
    ------
    AssertionError
        If a check fails, with one line that names the study and the broken part of the contract.
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
    """Check that the plan is deterministic, and that its blocks do not depend on the grid's order.

    Raises
    ------
    AssertionError
        If two plans differ in their keys, or reversing an axis of the grid changes the set of keys.
    """
    keys = _keys(study, config)
    assert keys == _keys(study, config), f"{study.name}: two plans of one configuration differ"
    for name, other in reversed_grids(config):
        assert set(_keys(study, other)) == set(keys), (
            f"{study.name}: the blocks depend on the order of grid.{name}; a block's content holds "
            "its own condition, never the grid's list"
        )


def check_keys(study: Study, config: Config) -> list[str]:
    """Check that every configuration key changes the keys of some blocks, or is declared inert.

    Returns
    -------
    list of str
        The configuration keys that were not checked, because no tried value was accepted.

    Raises
    ------
    AssertionError
        If an inert key changes the blocks' keys, or another key does not.
    """
    keys = set(_keys(study, config))
    untried = []
    for name, changes_numbers, other in variations(config):
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
    """Sweep twice; check that the second sweep computes nothing, and show and draw the run.

    Return the run.

    Raises
    ------
    AssertionError
        If a case fails, the second sweep computes a case, or nothing is shown or drawn.
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
    """Check that rows have the required columns and a valid status, and that no row appears twice.

    Raises
    ------
    AssertionError
        If a column is missing, two rows have equal `sort_columns`, a status is unknown, or a row
        has a reason and the status "ok", or neither.
    """
    identity = study.engine(config).sort_columns()
    conditions = [c.name for c in study.conditions(config) if not c.expands]
    needed = ["status", "reason", *identity, *conditions]
    missing = [name for name in needed if name not in rows.columns]
    assert not missing, f"{study.name}: rows lack the columns {', '.join(missing)}"
    repeated = rows[rows.duplicated(identity)]
    assert repeated.empty, (
        f"{study.name}: {len(repeated)} rows have the same {', '.join(identity)} as another; "
        "sort_columns must identify a row"
    )
    unknown = sorted(set(rows["status"]) - {OK, FAILED, UNABLE})
    assert not unknown, f"{study.name}: unknown status {', '.join(map(str, unknown))}"
    unexplained = (rows["status"] == OK) != (rows["reason"] == "")
    assert not unexplained.any(), f"{study.name}: a reason belongs to each row that is not ok"


def check_tables(study: Study, config: Config, tables: dict[str, pd.DataFrame]) -> None:
    """Check that there are tables, and that two of them have the columns that scripts rely on.

    The two are `summary` and `best_scheme`; either may be absent.

    Raises
    ------
    AssertionError
        If there is no table, or one of the two has other columns.
    """
    assert tables, f"{study.name}: a run has no table"
    conditions = [condition.name for condition in study.conditions(config)]
    for name, (before, after) in (("summary", SUMMARY), ("best_scheme", BEST_SCHEME)):
        if name not in tables:
            continue
        columns = tuple(column for column in tables[name].columns if column not in SETBACK)
        expected = (*before, *conditions, *after)
        assert columns == expected, (
            f"{study.name}: {name} has the columns {', '.join(columns)}, not {', '.join(expected)}"
        )


def check_blocks_alone(study: Study, config: Config) -> None:
    """Check that a block gives equal rows whether it runs alone or together with its group.

    Raises
    ------
    AssertionError
        If the rows differ.
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
    """Check that a failed case has a reason and does not make all other cases fail.

    Raises
    ------
    AssertionError
        If no case fails with this configuration, no case succeeds, or a reason is empty.
    """
    outcome = sweep(study, config)
    rows = outcome.run.cases()
    failed = rows[rows["status"] == FAILED]
    assert len(failed), f"{study.name}: no case fails under the overrides `failing`"
    assert (rows["status"] == OK).any(), f"{study.name}: one failing case takes all others with it"
    assert (failed["reason"] != "").all(), f"{study.name}: a failed case has no reason"


def _keys(study: Study, config: Config) -> list[str]:
    return list(make_plan(study, config))
