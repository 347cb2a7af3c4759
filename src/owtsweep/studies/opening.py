"""Open a stored run for reading.

The run's folder may come from another person, so no code that its files name is executed.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from owtsweep.config import Config, checked, require
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError
from owtsweep.io.reading import refuse_links, require_folder
from owtsweep.studies import registry
from owtsweep.sweep import asked
from owtsweep.sweep.runs import Run
from owtsweep.sweep.stored_plan import read_blocks, read_stored_plan


def open_run(folder: Path) -> Run:
    """Open the run that is stored in a folder, or one of its questions, `<run>/asked/<hash>`.

    Raises
    ------
    InputError
        If the folder holds no run, the run cannot be read by this version of the program, or the
        run's study is not installed.
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
    stored = read_stored_plan(folder, text)
    config = _make_config(path, plain, None if stored is None else stored.get("code"))
    tunings = [name for name in config.by_tuning() if name]
    plan = None if stored is None else read_blocks(folder, stored, tunings)
    study = registry.get_study(config.study)
    question = asked.name_question(study.config_type(), plain, text)
    return Run(folder, config, study, plan, question, home)


def load_config(path: Path) -> Config:
    """Read the configuration in a run's config.yaml, without reading other files of the run.

    Raises
    ------
    InputError
        If the file is missing, is not a configuration of this program, or belongs to a study that
        is not installed.
    """
    return _make_config(path, read_stored(path)[0], None)


def _make_config(path: Path, plain: dict[str, Any], described: Any) -> Config:
    name = str(plain.get("study", registry.DEFAULT))
    try:
        study = registry.get_study(name)
        keys = {**study.hide_code(plain, described), "study": name}
        config = checked(study.config_type(), keys)
        study.check(config)  # not `check_outside`, which opens the files that the keys name
        return config
    except InputError as error:
        if name not in registry.names():
            raise InputError(
                f"{path}: the study {name!r} of this run is not installed; install its package "
                f"(there are {', '.join(registry.names())})"
            ) from error
        raise InputError(f"{path}: {error}") from error
