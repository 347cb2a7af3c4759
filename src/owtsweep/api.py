"""The Python interface: what the command line does, without the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.sweep.runs import load

if TYPE_CHECKING:
    from owtsweep.sweep.runs import Run

__all__ = ["load", "run"]


def run(overrides: Sequence[str] = ()) -> Run:
    """Run a study, or finish one, and return it.

    Parameters
    ----------
    overrides
        Hydra overrides as on the command line, e.g. `["grid.replicates=2", "tuning=matched"]`.

    Returns
    -------
    Run
        With its `config`, `cases()`, `summary()` and `best_scheme()`. Failed cases stand among
        its cases with the status "failed" and a reason.

    Raises
    ------
    InputError
        If the overrides are wrong; nothing has been written then.
    """
    from owtsweep.config import compose
    from owtsweep.studies import get_study
    from owtsweep.sweep.run import sweep

    config = compose(overrides)
    return sweep(get_study(config.study), config).run
