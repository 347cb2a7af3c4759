"""`sweep`: run a study and draw its map."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.cli import BAD_INPUT, DONE, FAILED, same_command
from owtsweep.config import Config, compose, dump
from owtsweep.errors import InputError
from owtsweep.freed_memory import keep_freed_memory

if TYPE_CHECKING:
    from owtsweep.sweep.run import Outcome
    from owtsweep.sweep.worker import Failure

#: What the end of a sweep lists; run.log has all.
MOST_REASONS = 10
MOST_LABELS = 3


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Compose and check the configuration, then run it (or each of a multirun)."""
    if options.multirun:
        from owtsweep.cli.multirun import run_all

        return run_all(options, argv)
    config = compose(options.overrides, options.config_dir)
    if options.cfg:
        print(dump(config), end="")
        return DONE
    if options.fresh and not options.yes and not confirmed(config):
        print("owtsweep: nothing was deleted, nothing was run", file=sys.stderr)
        return BAD_INPUT
    return run_one(config, argv, fresh=options.fresh)


def confirmed(config: Config) -> bool:
    """Ask before stored cases are deleted; without a terminal the answer must be on the line."""
    from owtsweep.sweep.keys import run_folder

    folder = run_folder(config)
    if not (folder / "cases").is_dir():
        return True
    if not sys.stdin.isatty():
        raise InputError(f"--fresh: this would delete the cases in {folder}; add --yes")
    answer = input(f"Delete the cases in {folder} and start over? [y/N] ")
    return answer.strip().lower() in ("y", "yes")


def run_one(config: Config, argv: Sequence[str], *, fresh: bool = False) -> int:
    """Run one study, draw its overview, tell the result; returns the exit code."""
    from owtsweep.studies import get_study
    from owtsweep.sweep.progress import make_progress
    from owtsweep.sweep.run import sweep

    keep_freed_memory()
    study = get_study(config.study)
    progress = make_progress(quiet=False)
    outcome = sweep(study, config, fresh=fresh, progress=progress, argv=list(argv))
    drawn = tell(outcome, argv)
    return DONE if drawn and not outcome.failed else FAILED


def tell(outcome: Outcome, argv: Sequence[str]) -> bool:
    """Draw the overview and print the study's answer and where it lies.

    Returns whether the overview is drawn, or there is nothing to draw.
    """
    run = outcome.run
    tables = run.tables()
    drawn = _draw(outcome) if tables else True
    if tables and sys.stdout.isatty():
        from rich.console import Console

        Console().print(run.study.terminal(run.config, tables))
    if outcome.failed:
        for line in failure_lines(outcome.failed):
            print(line, file=sys.stderr)
        cases = sum(failure.cases for failure in outcome.failed)
        told = f"{_cases(cases)} failed; " if cases else ""
        print(f"{told}the same command tries again:", file=sys.stderr)
        print(f"  {same_command(argv)}", file=sys.stderr)
    reused = f", {outcome.reused} were there" if outcome.reused else ""
    print(f"{outcome.computed} cases computed{reused} in {outcome.seconds:.1f} s: {run.folder}/")
    return drawn


def _draw(outcome: Outcome) -> bool:
    try:
        outcome.run.draw(outcome.run.study.overview(), outcome.results)
    except OSError as error:
        reason = error.strerror or str(error)
        print(f"failed: the map could not be drawn: {reason}", file=sys.stderr)
        return False
    return True


def failure_lines(failures: Sequence[Failure]) -> list[str]:
    """Failures by reason, the commonest first: each with its cases and its first labels."""
    by_reason: dict[str, list[Failure]] = {}
    for failure in failures:
        by_reason.setdefault(failure.reason, []).append(failure)
    groups = sorted(by_reason.items(), key=lambda item: (-sum(f.cases for f in item[1]), item[0]))
    lines = []
    for reason, group in groups[:MOST_REASONS]:
        labels = list(dict.fromkeys(failure.label for failure in group))
        more = f" and {len(labels) - MOST_LABELS} more" if len(labels) > MOST_LABELS else ""
        cases = sum(failure.cases for failure in group)
        count = f"{_cases(cases)}: " if cases else ""
        lines.append(f"failed: {count}{reason}: {'; '.join(labels[:MOST_LABELS])}{more}")
    if len(groups) > MOST_REASONS:
        lines.append(f"failed: {len(groups) - MOST_REASONS} more reasons: see run.log")
    return lines


def _cases(number: int) -> str:
    return f"{number} case" if number == 1 else f"{number} cases"
