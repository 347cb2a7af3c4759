"""`figures`: draw all figures of a run."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Draw all figures of a run into its folder figures/."""
    from owtsweep.api import load

    opened = load(options.run)
    files = opened.draw()
    print(f"{len(files)} files: {opened.folder / 'figures'}/")
    return DONE
