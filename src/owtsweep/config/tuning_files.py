"""Tunings from the user's own files: `tuning=./mine.yaml` beside the tunings that have a name.

Such a file may set the tuned sections of a study's configuration (`Config.tuned`) and the key
`tuning`, the tuning's name; without it, the name is the file's. The file may come from a stranger,
so it holds values only: it is checked as a stored configuration is, and then handed to Hydra as one
more file of the config group `tuning`.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from owtsweep.config.stored import read_stored
from owtsweep.config.tunings import GROUP
from owtsweep.errors import InputError, require, shorten
from owtsweep.io.reading import expand_home


def names_file(word: str) -> bool:
    """Return whether a value of the key `tuning` is a file: it has a slash or ends in .yaml."""
    return "/" in word or word.endswith(".yaml")


def list_tunings(override: str) -> list[str]:
    """Return the tunings of an override `tuning=NAME` or `tuning=[NAME,FILE]`; else []."""
    key, _, value = override.lstrip("+").partition("=")
    if key != GROUP:
        return []
    inner = value.strip()
    if inner.startswith("[") and inner.endswith("]"):
        return [word.strip().strip("'\"") for word in inner[1:-1].split(",")]
    return [inner.strip("'\"")]


@contextmanager
def place_files(
    overrides: Sequence[str], tuned: Sequence[str]
) -> Iterator[tuple[list[str], list[Path]]]:
    """Give the tuning files that overrides name a place and a name for Hydra, for a while.

    Parameters
    ----------
    overrides
        The user's overrides.
    tuned
        The sections that a tuning file may set; if there are none, nothing is changed.

    Yields
    ------
    tuple
        The overrides, with the name of an option in place of each file's path; and the folders that
        Hydra has to search for these options, none or one.

    Raises
    ------
    InputError
        If a file cannot be read, holds anything but values, or sets another key.
    """
    files = [word for o in overrides for word in list_tunings(o) if names_file(word)]
    if not files or not tuned:
        yield list(overrides), []
        return
    with tempfile.TemporaryDirectory(prefix="owtsweep-") as folder:
        group = Path(folder) / GROUP
        group.mkdir()
        options = {word: f"tuning-file-{n}" for n, word in enumerate(dict.fromkeys(files))}
        for word, option in options.items():
            text = _checked_text(expand_home(word), tuned)
            (group / f"{option}.yaml").write_text(text, encoding="utf-8")
        try:
            yield [_replace(override, options) for override in overrides], [Path(folder)]
        except InputError as error:  # in the user's words
            told = str(error)
            for word, option in options.items():
                told = told.replace(option, word)
            raise InputError(told) from error


def _replace(override: str, options: dict[str, str]) -> str:
    tunings = list_tunings(override)
    if not any(word in options for word in tunings):
        return override
    return f"{GROUP}=[{','.join(options.get(word, word) for word in tunings)}]"


def _checked_text(path: Path, tuned: Sequence[str]) -> str:
    """Read a tuning file; return its values as the text of a file of Hydra's config group."""
    import yaml

    require(  # `Path.exists` raises for a name that is too long
        os.path.exists(path), f"{GROUP}: there is no file {shorten(str(path), 200)}"
    )
    plain, _ = read_stored(path)
    others = sorted(set(plain) - {*tuned, GROUP})
    require(
        not others,
        f"{path}: a tuning file sets {', '.join(tuned)} and {GROUP}, not {', '.join(others)}; give "
        "other keys on the command line",
    )
    name = plain.setdefault(GROUP, path.stem)
    require(
        isinstance(name, str),
        f"{path}: {GROUP}: {name!r} is no text; write the tuning's name there",
    )
    return f"# @package _global_\n{yaml.safe_dump(plain, sort_keys=False)}"
