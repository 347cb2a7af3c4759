"""What the commands `sweep` and `replay` do before and after a run."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.cli.program import DONE, FAILED, same_command
from owtsweep.config import Config
from owtsweep.errors import InputError
from owtsweep.freed_memory import keep_freed_memory

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.sweep.rows import Setback
    from owtsweep.sweep.run import Outcome
    from owtsweep.sweep.runs import Run

#: Most reasons listed at the end of a sweep; run.log has all.
MOST_REASONS = 10
MOST_LABELS = 3


def may_start(options: argparse.Namespace, config: Config) -> bool:
    """Return whether a run may start; ask the user before `--fresh` deletes the run's cases.

    Without `--fresh`, with `--yes`, or if the run has no stored cases, return True and ask
    nothing. If the user says no, print that nothing was done, and return False.

    Parameters
    ----------
    options
        The parsed arguments of the command.
    config
        The configuration of the run.

    Raises
    ------
    InputError
        If the user would have to be asked, but stdin is no terminal.
    """
    from owtsweep.sweep.keys import run_folder

    folder = run_folder(config)
    if not options.fresh or options.yes or not (folder / "cases").is_dir():
        return True
    if not sys.stdin.isatty():
        raise InputError(f"--fresh: this would delete the cases in {folder}; add --yes")
    answer = input(f"Delete the cases in {folder} and start over? [y/N] ")
    if answer.strip().lower() in ("y", "yes"):
        return True
    print("owtsweep: nothing was deleted, nothing was run", file=sys.stderr)
    return False


def run_one(config: Config, argv: Sequence[str], *, fresh: bool = False) -> int:
    """Make one run, draw its overview figure, print its result, and return the exit code.

    The result is printed only if stdout is a terminal. The exit code is 1 if a case failed or the
    figure or the result could not be made, otherwise 0.

    Parameters
    ----------
    config
        The configuration of the run.
    argv
        The words of the command line, which the run stores.
    fresh
        Whether to delete the run's stored cases first.
    """
    from owtsweep.studies import get_study
    from owtsweep.sweep.progress import make_progress
    from owtsweep.sweep.run import sweep

    keep_freed_memory()
    study = get_study(config.study)
    outcome = sweep(study, config, fresh=fresh, progress=make_progress(), argv=argv)
    tables = written_tables(outcome)
    shown = _draw_overview(outcome) if tables else True
    if tables and sys.stdout.isatty():
        shown &= print_answer(outcome.run, tables)
    code = tell_end(outcome, argv, f"{outcome.run.folder}/")
    return code if shown else FAILED


def written_tables(outcome: Outcome) -> dict[str, pd.DataFrame]:
    """Read the tables that a run has written, by name; an empty dict if no case has succeeded."""
    names = () if outcome.results is None else outcome.results.tables
    there = [name for name in names if (outcome.run.folder / f"{name}.csv").exists()]
    return {name: outcome.run.table(name) for name in there}


def _draw_overview(outcome: Outcome) -> bool:
    """Draw the overview figure of a run; return whether the figure could be drawn.

    If the figure could not be drawn, the reason is printed to stderr. The run's stored cases and
    tables are kept.
    """
    from owtsweep.io.files import refuse_in_one_line
    from owtsweep.sweep.study import blame

    run = outcome.run
    try:
        with refuse_in_one_line(run.folder / "figures"):
            with blame(run.study):
                overview = run.engine.overview(run.config)
            run.draw(overview, outcome.results)
    except InputError as error:
        print(f"failed: the map could not be drawn: {error}", file=sys.stderr)
        return False
    return True


def print_answer(run: Run, tables: dict[str, pd.DataFrame], width: int | None = None) -> bool:
    """Print the result of a run in a few lines; return whether the study could make these lines.

    If the study could not make the lines, the reason is printed to stderr.

    Parameters
    ----------
    run
        The run.
    tables
        The run's tables by name.
    width
        Width of the lines in characters; None means the width of the terminal.
    """
    from rich.console import Console

    from owtsweep.sweep.study import blame

    try:
        with blame(run.study):
            Console(width=width).print(run.engine.terminal(run.config, tables))
    except InputError as error:
        print(f"failed: the result could not be shown: {error}", file=sys.stderr)
        return False
    return True


def tell_end(outcome: Outcome, argv: Sequence[str], place: str) -> int:
    """Print how a run ended, and return the exit code: 1 if cases failed, else 0.

    First, cases that failed or that a scheme cannot compute are printed to stderr, with reasons.
    Then the number of computed cases is printed, with the text `place`, which says where the
    results are. `argv` are the words of the command line, to be repeated if cases failed.
    """
    for line in setback_lines("unable", outcome.unable) + setback_lines("failed", outcome.failed):
        print(line, file=sys.stderr)
    if outcome.failed:
        cases = sum(setback.cases for setback in outcome.failed)
        told = f"{_count(cases)} failed; " if cases else ""
        print(f"{told}the same command tries again:", file=sys.stderr)
        print(f"  {same_command(argv)}", file=sys.stderr)
    reused = f", {outcome.reused} were there" if outcome.reused else ""
    print(f"{outcome.computed} cases computed{reused} in {outcome.seconds:.1f} s: {place}")
    return FAILED if outcome.failed else DONE


def setback_lines(word: str, setbacks: Sequence[Setback]) -> list[str]:
    """Return lines about cases without a result: one line per reason, the commonest reason first.

    A line holds `word` (e.g. "failed"), the number of cases with this reason, the reason, and the
    labels of at most `MOST_LABELS` of their blocks. A block is a group of cases computed
    together. If there are more than `MOST_REASONS` reasons, a last line says how many are left
    out. A setback is a number of cases of one block that have no result for one reason.
    """
    by_reason: dict[str, list[Setback]] = {}
    for setback in setbacks:
        by_reason.setdefault(setback.reason, []).append(setback)
    groups = sorted(by_reason.items(), key=lambda item: (-sum(s.cases for s in item[1]), item[0]))
    lines = []
    for reason, group in groups[:MOST_REASONS]:
        labels = list(dict.fromkeys(setback.label for setback in group))
        more = f" and {len(labels) - MOST_LABELS} more" if len(labels) > MOST_LABELS else ""
        cases = sum(setback.cases for setback in group)
        count = f"{_count(cases)}: " if cases else ""
        lines.append(f"{word}: {count}{reason}: {'; '.join(labels[:MOST_LABELS])}{more}")
    if len(groups) > MOST_REASONS:
        lines.append(f"{word}: {len(groups) - MOST_REASONS} more reasons: see run.log")
    return lines


def _count(cases: int) -> str:
    return f"{cases} case" if cases == 1 else f"{cases} cases"
