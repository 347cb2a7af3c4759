"""`sweep`: run a study and draw its map."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.cli import BAD_INPUT, DONE, FAILED
from owtsweep.config import Config, compose, dump
from owtsweep.errors import InputError

if TYPE_CHECKING:
    from owtsweep.sweep.run import Outcome


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Compose and check the configuration, then run it (or each of a multirun)."""
    if options.multirun:
        from owtsweep.commands.multirun import run_all

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

    study = get_study(config.study)
    progress = make_progress(quiet=False)
    outcome = sweep(study, config, fresh=fresh, progress=progress, argv=list(argv))
    tell(outcome)
    return FAILED if outcome.failed else DONE


def tell(outcome: Outcome) -> None:
    """Draw the overview and print the study's answer and where it lies."""
    run = outcome.run
    tables = run.tables()
    if tables:
        run.draw(run.study.overview(), outcome.results)
        if sys.stdout.isatty():
            from rich.console import Console

            Console().print(run.study.terminal(run.config, tables))
    for failure in outcome.failed:
        print(f"failed: {failure.label}: {failure.reason}", file=sys.stderr)
    if outcome.failed:
        cases = sum(failure.cases for failure in outcome.failed)
        plural = "case" if cases == 1 else "cases"
        print(f"{cases} {plural} failed; the same command tries again", file=sys.stderr)
    reused = f", {outcome.reused} were there" if outcome.reused else ""
    print(f"{outcome.computed} cases computed{reused} in {outcome.seconds:.1f} s: {run.folder}/")
