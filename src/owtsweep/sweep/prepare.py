"""Prepares a run folder for a sweep: checks it first, then writes configuration and plan."""

from __future__ import annotations

from collections.abc import Mapping

from owtsweep.config import require, typed
from owtsweep.config.stored import read_stored
from owtsweep.io.files import check_writable, remove_stale, unwritable
from owtsweep.io.reading import refuse_links
from owtsweep.sweep import asked
from owtsweep.sweep.keys import run_hash
from owtsweep.sweep.plan import PLAN_FILE, is_of_other_version
from owtsweep.sweep.runs import Run

#: Files in the root of a run folder that a sweep writes, besides tables.
FILES = (asked.CONFIG, PLAN_FILE, "manifest.json", "run.log")


def check_folder(run: Run, *, fresh: bool) -> None:
    """Check that a sweep can write its run folder; write nothing.

    Raises
    ------
    InputError
        If a file or folder is in the way or cannot be written; or if `fresh` is False, and the
        folder holds a run of another version, or the folder that the user named another run.
    """
    own = asked.question_folder(run.folder, run.question)
    # else run.log would be appended to its target, and --fresh would delete what lies elsewhere
    refuse_links(run.folder, but=(run.store.cases.name,))
    for folder in (run.folder, run.store.cases, own):
        check_writable(folder)
    for folder, names in ((run.folder, FILES), (own, FILES[:-1])):
        # The tables of the study have no names yet, but every CSV file of a run is a table.
        for path in (*(folder / name for name in names), *folder.glob("*.csv")):
            kind = "folder" if path.is_dir() else "pipe or a device"
            require(
                path.is_file() or not path.exists(),
                f"{path}: this is a {kind} where a file belongs; move it away",
            )
    if not fresh:
        require(
            not is_of_other_version(run.study, run.folder),
            f"{run.folder}: this run was made by another version of owtsweep; to run it again, add "
            "--fresh or delete the folder",
        )
        if run.config.name is not None:
            _require_same_run(run)


def prepare_folder(run: Run, texts: Mapping[str, str], *, fresh: bool) -> None:
    """Check and make a run folder, and write the configuration and the plan there.

    Parameters
    ----------
    run
        The run.
    texts
        File name -> content, for config.yaml and plan.json.
    fresh
        If True, first delete what the folder holds: shards, tables, figures and all questions.

    Raises
    ------
    InputError
        As `check_folder`, or if the file system refuses a file.
    """
    check_folder(run, fresh=fresh)
    try:
        run.store.cases.mkdir(parents=True, exist_ok=True)
        if fresh:
            run.store.clear()
            asked.clear(run.folder)
        asked.show(run.folder, type(run.config), run.question, texts, cleared=fresh)
    except OSError as error:
        raise unwritable(run.folder, error) from error
    for folder in (run.folder, run.store.cases, asked.question_folder(run.folder, run.question)):
        remove_stale(folder)


def _require_same_run(run: Run) -> None:
    """Raise InputError if a folder that the user named holds another run.

    The tables of two runs must not be mixed.
    """
    path = run.folder / asked.CONFIG
    if path.is_file():
        plain, _ = read_stored(path)
        # of another study's configuration the keys would not be known
        same_study = plain.get("study") == run.config.study
        model = type(run.config)
        require(
            same_study and run_hash(typed(model, plain)) == run.hash,
            f"name: {run.folder} holds a run with other settings; choose another name, or add "
            "--fresh to replace it",
        )
