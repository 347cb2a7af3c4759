"""`fidelity`: compare a run with the published results."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE
from owtsweep.config import require
from owtsweep.errors import InputError, printable


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write tables, figures and the report into the run's folder fidelity/, and return 0.

    Raises
    ------
    InputError
        If the run's study has no published results, or the run has no records or no succeeded case.
    """
    from owtsweep.api import load
    from owtsweep.io.files import refuse_in_one_line
    from owtsweep.io.steps import show_steps
    from owtsweep.sweep.study import OK, Judged, blame

    opened = load(options.run)
    study = opened.study
    if not isinstance(study, Judged):
        raise InputError(
            f"{opened.folder}: this is a run of study {study.name!r}, which has no published "
            "results; name a run of a study that has"
        )
    require(
        opened.engine.samples,
        f"{opened.folder}: this run has no records, so nothing has an interval to be judged by; "
        "name a run with engine=batch",
    )
    rows = opened.cases()
    require(
        bool((rows["status"] == OK).any()),
        f"{opened.folder}: no case of this run has succeeded; run its sweep again",
    )
    folder = opened.folder / "fidelity"
    with refuse_in_one_line(folder), show_steps(), blame(study):
        files = study.write_fidelity(opened.config, rows, folder, metadata=opened.metadata())
    print(f"{len(files)} files: {printable(str(folder / 'fidelity.html'))}")
    return DONE
