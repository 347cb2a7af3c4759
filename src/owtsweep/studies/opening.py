"""Open a stored run for reading.

The run's folder may come from another person, so no code that its files name is executed.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from owtsweep.config import checked, require
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError
from owtsweep.io.reading import refuse_links, require_folder
from owtsweep.studies import registry
from owtsweep.sweep import asked
from owtsweep.sweep.keys import question_hash
from owtsweep.sweep.plan import read_plan, read_stored_plan
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import Study


def open_run(folder: Path) -> Run:
    """Open the run that is stored in a folder, or one of its queries, `<run>/asked/<hash>`.

    Raise `InputError` if the folder holds no run, the run cannot be read by this version of the
    program, or the run's study is not installed.
    """
    path = folder / "config.yaml"
    require_folder(folder)
    home = asked.find_home(folder)
    refuse_links(home or folder, but=("cases",))  # the store reads shards, but no links
    require(
        os.path.lexists(path),
        f"{folder}: the folder holds no config.yaml; name the folder of a run",
    )
    plain, text = read_stored(path)
    study = _find_study(path, plain)
    stored = read_stored_plan(study, folder, text)
    try:
        config = checked(study.config_type(), study.hide_code(plain, stored.get("code")))
        study.check(config)  # not `check_outside`, which opens the files that the keys name
        study.check_over(config)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    plan = read_plan(folder, stored, config)
    return Run(folder, config, study, plan, question_hash(config), home)


def _find_study(path: Path, plain: dict[str, Any]) -> Study:
    name = str(plain.get("study", registry.DEFAULT))
    try:
        return registry.get_study(name)
    except InputError as error:
        if name not in registry.names():
            raise InputError(
                f"{path}: the study {name!r} of this run is not installed; install its package "
                f"(there are {', '.join(registry.names())})"
            ) from error
        raise InputError(f"{path}: {error}") from error
