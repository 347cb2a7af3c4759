"""Keeps the answers to different questions apart in one run folder.

A question is what a sweep was asked: the whole configuration, with grid and schemes. Its
configuration, plan, tables and figures are kept in `asked/<hash>/`. The root of the run folder
shows the question that was asked last, so that scripts find its files at fixed places; the file
`asked/latest` names this question. The shards of all questions are shared, in `cases/`.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from owtsweep.config import Config, typed
from owtsweep.config.stored import MOST_BYTES, read_stored
from owtsweep.errors import InputError
from owtsweep.io.files import write_all, write_atomically
from owtsweep.io.reading import read_text
from owtsweep.sweep.keys import hash_text, question_hash

FOLDER = "asked"
LATEST = "latest"
CONFIG = "config.yaml"
#: The page of a run; and what is kept for it on request.
PAGE, DETAILS = "report.html", "details.json"
#: What is made of a question's cases and lies in the root of the run folder, besides the tables.
MADE = (
    "figures", "fidelity", "report.md", PAGE, DETAILS, "estimates.parquet", "estimates", "records",
)  # fmt: skip
_HASH = re.compile(r"[0-9a-f]{10}")


@dataclass(frozen=True)
class Question:
    """A question that a run folder has answered, or began to answer.

    hash: the name of the question's folder below `asked`.
    config: the stored configuration as plain data, which is not checked; {} if it cannot be read.
    trouble: Why the configuration cannot be read, in one line; "" if it can.
    """

    hash: str
    config: Mapping[str, object]
    trouble: str = ""


def question_folder(run: Path, question: str) -> Path:
    """Return the folder of a question in a run folder; the folder may not exist."""
    return run / FOLDER / question


def find_home(folder: Path) -> Path | None:
    """Return the run folder if `folder` is that of a question, `<run>/asked/<hash>`; else None."""
    whole = Path(os.path.abspath(folder))
    is_question = whole.parent.name == FOLDER and _HASH.fullmatch(whole.name) is not None
    return whole.parents[1] if is_question else None


def list_questions(run: Path) -> Iterator[Question]:
    """Yield the questions of a run folder, sorted by hash; their files may be another person's."""
    for path in sorted((run / FOLDER).glob("*/config.yaml")):
        if _HASH.fullmatch(path.parent.name):
            try:
                yield Question(path.parent.name, read_stored(path)[0])
            except InputError as error:
                yield Question(path.parent.name, {}, str(error))


def is_shown(run: Path, question: str) -> bool:
    """Return whether the root of a run folder shows this question, the one that was asked last."""
    return question_folder(run, question).is_dir() and _latest(run) == question != ""


def _latest(run: Path) -> str:
    """Return the hash of the question that was asked last; "" if nobody can say."""
    try:
        text = read_text(run / FOLDER / LATEST, MOST_BYTES).strip()
    except InputError:
        return ""
    return text if _HASH.fullmatch(text) else ""


def write_both(run: Path, question: str, contents: Mapping[str, bytes | str]) -> None:
    """Write files, name -> content, into a question's folder, and into the root if shown there.

    If the files do not all fit on the disk, none of them is changed.

    Raises OSError if the file system refuses a file.
    """
    shown = is_shown(run, question)
    folders = [question_folder(run, question), *[run] * shown]
    write_all({folder / name: text for folder in folders for name, text in contents.items()})
    if shown and not is_shown(run, question):  # another sweep has just begun
        _give_back(run, contents)


def _give_back(run: Path, names: Iterable[str]) -> None:
    """Replace files in the root by those of the question that the root shows, or delete them."""
    own = question_folder(run, _latest(run))
    for name in names:
        if (own / name).is_file():
            write_atomically(run / name, (own / name).read_bytes())
        else:
            (run / name).unlink(missing_ok=True)


def show_figures(run: Path, question: str, files: list[Path]) -> list[Path]:
    """Copy figures from the folder of their question into the root, if the root shows the question.

    Return the copies, or `files` if there are none.

    Raises OSError if the file system refuses a file.
    """
    if not is_shown(run, question):
        return files
    (run / "figures").mkdir(exist_ok=True)
    write_both(run, question, {f"figures/{path.name}": path.read_bytes() for path in files})
    return [run / "figures" / path.name for path in files]


def show(
    run: Path,
    model: type[Config],
    question: str,
    texts: Mapping[str, str],
    *,
    cleared: bool = False,
) -> None:
    """Make a question the one that the root of the run folder shows.

    What the root holds of another question moves into the folder of that question: tables,
    figures, reports and estimates. What the folder of this question holds returns to the root.

    run: the run folder, which exists.
    model: the class of the study's configurations.
    question: the hash of the question.
    texts: File name -> content: the configuration and the plan of the question.
    cleared: whether `clear` has just been called, so that nothing is left to move.
    Raises OSError if the file system refuses a file.
    """
    own = question_folder(run, question)
    own.mkdir(parents=True, exist_ok=True)
    # First, because a full disk must be noticed before anything is moved.
    write_all({own / name: text for name, text in texts.items()})
    # From now on a sweep that asks another question writes no more into the root.
    write_atomically(run / FOLDER / LATEST, f"{question}\n")
    if os.path.lexists(run / CONFIG) and not cleared:
        try:  # no code that the configuration names is imported
            before = question_hash(typed(model, read_stored(run / CONFIG)[0]))
        except InputError:  # damaged, so nobody can say to which question the tables belong
            before = hash_text("damaged")
        if before != question:
            _move_made(run, question_folder(run, before))
            _return_made(run, own)
    write_all({run / name: text for name, text in texts.items()})


def clear(run: Path) -> None:
    """Delete the folders of all questions, and what the root holds of a question."""
    for path in [*_list_made(run), *(run / FOLDER).glob("*")]:
        if path.parent.name == FOLDER and not _HASH.fullmatch(path.name):
            continue  # not of this program
        _delete(path)


def _list_made(run: Path) -> list[Path]:
    """Return the paths in the root of a run folder that were made of a question's cases.

    A CSV file is a table if a question has a table of this name. Other CSV files are the user's.
    """
    tables = {path.name for path in (run / FOLDER).glob("*/*.csv")}
    made = [path for path in run.glob("*.csv") if path.name in tables]
    return made + [run / name for name in MADE if os.path.lexists(run / name)]


def _move_made(run: Path, target: Path) -> None:
    """Move what the root holds of a question into the question's folder, `target`."""
    for path in _list_made(run):
        target.mkdir(parents=True, exist_ok=True)
        if path.is_dir() and not path.is_symlink() and (target / path.name).is_dir():
            # Files that only the question's folder has are kept: other figures, say.
            for inner in list(path.iterdir()):
                _move(inner, target / path.name / inner.name)
            path.rmdir()
        else:
            _move(path, target / path.name)


def _return_made(run: Path, own: Path) -> None:
    """Bring what a question's folder, `own`, holds into the root: tables and figures as copies."""
    files = [path for path in (*own.glob("*.csv"), *own.glob("figures/*")) if path.is_file()]
    if (own / "figures").is_dir():
        (run / "figures").mkdir(exist_ok=True)
    write_all({run / path.relative_to(own): path.read_bytes() for path in files})
    for name in MADE:
        if name != "figures" and os.path.lexists(own / name):
            _move(own / name, run / name)


def _move(path: Path, target: Path) -> None:
    if os.path.lexists(target):
        _delete(target)
    path.rename(target)


def _delete(path: Path) -> None:
    """Delete a file, a link (not what it names), or a folder with its content."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
