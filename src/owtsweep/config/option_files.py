"""Options of config groups from the user's own files: `tuning=./mine.yaml`, `structure=./my.yaml`.

A tuning file may set the tuned sections of a study's configuration (`Config.tuned`) and the key
`tuning`, the tuning's name; without it, the name is the file's. A file of another group
(`Config.from_files`) sets the keys of one section. A file may come from a stranger, so it holds
values only: it is checked as a stored configuration is, and then handed to Hydra as one more option
of the config group.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from owtsweep.config.common import Config
from owtsweep.config.section import Plain, bare_type, is_section
from owtsweep.config.stored import read_stored
from owtsweep.config.tuned import GROUP
from owtsweep.config.typed import typed
from owtsweep.errors import InputError, require, shorten
from owtsweep.io.reading import expand_home

#: Numbers of files: no two threads give two files one name.
_NUMBER = itertools.count()


def names_file(word: str) -> bool:
    """Return whether an option of a config group is a file: it has a slash or ends in .yaml."""
    return "/" in word or word.endswith(".yaml")


@contextmanager
def place_files(overrides: Sequence[str], model: type[Config]) -> Iterator[list[str]]:
    """Give the files that overrides of groups name a name for Hydra; yield overrides with it.

    The model's `tuned` and `from_files` say what files may set. Raise `InputError` if a file cannot
    be read, holds anything but values, or sets another key.
    """
    from hydra.core.config_store import ConfigStore

    options: dict[tuple[str, str], str] = {}
    for override in overrides:
        group, words = _split(override)
        if group in model.from_files or (group == GROUP and model.tuned):
            for word in filter(names_file, words):
                options.setdefault((group, word), f"{group}-file-{next(_NUMBER)}")
    store = ConfigStore.instance()
    try:
        for (group, word), option in options.items():
            package = "_global_" if group == GROUP else group
            store.store(option, _read_checked(expand_home(word), group, model), group, package)
        yield [_replace(override, options) for override in overrides]
    except InputError as error:  # in the user's words
        text = str(error)
        for (_, word), option in options.items():
            text = text.replace(option, word)
        raise InputError(text) from error
    finally:  # other configurations know nothing of these options
        for (group, _), option in options.items():
            names = store.repo.get(group, {})
            names.pop(f"{option}.yaml", None)
            if not names:
                store.repo.pop(group, None)


def _split(override: str) -> tuple[str, list[str]]:
    """Return the group and the options of an override `group=NAME` or `group=[NAME,FILE]`."""
    group, _, value = override.lstrip("+").partition("=")
    value = value.strip()
    listed = value.startswith("[") and value.endswith("]")
    words = value[1:-1].split(",") if listed else [value]
    return group, [word.strip().strip("'\"") for word in words]


def _replace(override: str, options: dict[tuple[str, str], str]) -> str:
    group, words = _split(override)
    if not any((group, word) in options for word in words):
        return override
    chosen = ",".join(options.get((group, word), word) for word in words)
    return f"{group}=[{chosen}]" if group == GROUP else f"{group}={chosen}"


def _read_checked(path: Path, group: str, model: type[Config]) -> Plain:
    """Read a user's file of a config group; return its values."""
    require(  # `Path.exists` raises for a name that is too long
        os.path.exists(path), f"{group}: there is no file {shorten(str(path), 200)}"
    )
    plain, _ = read_stored(path)
    if group != GROUP:
        section = bare_type(model.model_fields[group].annotation)
        assert is_section(section), group
        try:
            typed(section, plain)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error
        return plain
    others = sorted(set(plain) - {*model.tuned, GROUP})
    require(
        not others,
        f"{path}: a tuning file sets {', '.join(model.tuned)} and {GROUP}, not "
        f"{', '.join(others)}; give other keys on the command line",
    )
    name = plain.setdefault(GROUP, path.stem)
    require(
        isinstance(name, str),
        f"{path}: {GROUP}: {name!r} is no text; write the tuning's name there",
    )
    return plain
