"""The command `figures`: draw all figures of a run."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Draw all figures of the run `options.run` into its subfolder figures/, and return 0.

    `options` are the parsed arguments of the command; `argv` is not used.
    """
    from owtsweep.api import load
    from owtsweep.errors import printable
    from owtsweep.io.files import refuse_in_one_line
    from owtsweep.io.steps import show_steps

    opened = load(options.run)
    folder = opened.place / "figures"
    with refuse_in_one_line(folder), show_steps():
        files = opened.draw()
    print(f"{len(files)} files: {printable(str(folder))}/")
    return DONE
