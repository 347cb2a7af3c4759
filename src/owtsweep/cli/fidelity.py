"""The command `fidelity`: compare a run with the published results of its study."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE
from owtsweep.config import require
from owtsweep.errors import InputError, printable


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Compare the run `options.run` with published results; write a report, and return 0.

    Tables, figures and the report are written into the subfolder fidelity/ of the run's folder.
    `options` are the parsed arguments of the command; `argv` is not used.

    With several tunings, each has a folder of its own: fidelity/<tuning>/.

    Raises
    ------
    InputError
        If the run's study has no published results, or a script of its own that judges them; if
        the run holds expected values instead of records, or no case of it has succeeded.
    """
    from owtsweep.api import load
    from owtsweep.io.files import refuse_in_one_line
    from owtsweep.io.steps import show_steps
    from owtsweep.sweep.study import OK, Judged, blame

    opened = load(options.run)
    study = opened.study
    script = getattr(study, "judged_by", None)
    if script is not None:
        raise InputError(
            f"{opened.folder}: a run of study {study.name!r} has one truth, and the statements of "
            f"its paper compare several on the same records; they are judged by {script} of the "
            "project's repository; run that"
        )
    if not isinstance(study, Judged):
        raise InputError(
            f"{opened.folder}: this is a run of study {study.name!r}, which has no published "
            "results; name a run of a study with published results"
        )
    require(
        opened.engine.samples,
        f"{opened.folder}: this run has no records, so its results have no intervals; "
        "name a run with engine=batch",
    )
    parts = {tuning: (part, part.cases()) for tuning, part in opened.by_tuning().items()}
    require(
        all(bool((rows["status"] == OK).any()) for _, rows in parts.values()),
        f"{opened.folder}: no case of this run has succeeded; run its sweep again",
    )
    for tuning, (part, rows) in parts.items():
        folder = opened.place / "fidelity" / tuning
        with refuse_in_one_line(folder), show_steps(), blame(study):
            files = study.write_fidelity(part.config, rows, folder, metadata=opened.metadata())
        print(f"{len(files)} files: {printable(str(folder / 'fidelity.html'))}")
    return DONE
