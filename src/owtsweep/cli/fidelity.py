"""`fidelity`: hold a run against the published results."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli import DONE
from owtsweep.errors import InputError

#: The study that has published results.
STUDY = "hub"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write tables, figures and the report into the run's folder fidelity/."""
    from owtsweep.api import load
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.study import OK

    opened = load(options.run)
    config = opened.config
    if opened.study.name != STUDY or not isinstance(config, HubConfig):
        raise InputError(
            f"{opened.folder}: this is a run of study {opened.study.name!r}, which has no "
            f"published results; name a run of study {STUDY!r}"
        )
    if config.engine == "expected":
        raise InputError(
            f"{opened.folder}: this run has no records, so nothing has an interval to be judged "
            "by; name a run with engine=batch"
        )
    rows = opened.cases()
    if not (rows["status"] == OK).any():
        raise InputError(f"{opened.folder}: no case of this run has succeeded; run its sweep again")

    from owtsweep.studies.hub.fidelity.report import write_report

    folder = opened.folder / "fidelity"
    metadata = {"run": opened.hash, "folder": opened.folder.name}
    files = write_report(config, rows, folder, name=opened.folder.name, metadata=metadata)
    print(f"{len(files)} files: {folder / 'fidelity.html'}")
    return DONE
