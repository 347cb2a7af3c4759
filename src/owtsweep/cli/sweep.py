"""`sweep`: run a study and draw its map."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import BAD_INPUT, DONE
from owtsweep.cli.running import may_start, run_one


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Run one study, or all runs of a multirun, and return the exit code.

    With `--cfg`, print the configuration instead.
    """
    if options.multirun:
        from owtsweep.cli.multirun import run_all

        return run_all(options, argv)
    from owtsweep.config import dump
    from owtsweep.studies import compose

    config = compose(options.overrides, options.config_dir)
    if options.cfg:
        print(dump(config), end="")
        return DONE
    if not may_start(options, config):
        return BAD_INPUT
    return run_one(config, argv, fresh=options.fresh)
