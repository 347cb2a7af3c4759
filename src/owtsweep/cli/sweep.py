"""The command `sweep`: run a study and draw its map of the best schemes."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import BAD_INPUT, DONE
from owtsweep.cli.running import foretell, may_start, run_one
from owtsweep.config import dump_with_units


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Make one run of a study, or with `--multirun` several runs, and return the exit code.

    With `--cfg`, print the configuration and run nothing; with `--dry-run`, print what the sweep
    would do.

    options: the parsed arguments of the command.
    argv: the words of the command line.
    Raises InputError if the configuration is refused.
    """
    if options.multirun:
        from owtsweep.cli.multirun import run_all

        return run_all(options, argv)
    from owtsweep.studies import compose

    config = compose(options.overrides, options.config_dir)
    if options.cfg:
        print(dump_with_units(config), end="")
        return DONE
    if options.dry_run:
        return foretell([config], fresh=options.fresh)
    if not may_start(options, config):
        return BAD_INPUT
    return run_one(config, argv, fresh=options.fresh)
