"""Sections from the user's own files: `structure=./mine.yaml` beside the options that have a name.

Such a file sets the keys of one section of a configuration. It may come from a stranger, so it
holds values only: it is checked as a stored configuration is, and against the section's model, and
then handed to Hydra as one more file of the config group.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from owtsweep.config.common import Config
from owtsweep.config.section import bare_type
from owtsweep.config.stored import read_stored
from owtsweep.config.tuning_files import names_file
from owtsweep.config.typed import typed
from owtsweep.errors import InputError
from owtsweep.io.reading import expand_home


@contextmanager
def place_section_files(
    overrides: Sequence[str], model: type[Config]
) -> Iterator[tuple[list[str], list[Path]]]:
    """Give the files that overrides of groups name a place and a name for Hydra, for a while.

    Parameters
    ----------
    overrides
        The user's overrides.
    model
        The model of the configuration; its `from_files` are the groups.

    Yields
    ------
    tuple
        The overrides, with the name of an option in place of each file's path; and the folders that
        Hydra has to search for these options, none or one.

    Raises
    ------
    InputError
        If a file cannot be read, holds anything but values, or is no such section.
    """
    named = {override: _split(override, model) for override in overrides}
    files = {override: found for override, found in named.items() if found}
    if not files:
        yield list(overrides), []
        return
    with tempfile.TemporaryDirectory(prefix="owtsweep-") as folder:
        options = {}
        for number, (override, (group, word)) in enumerate(files.items()):
            options[override] = f"{group}={group}-file-{number}"
            path = Path(folder) / group / f"{group}-file-{number}.yaml"
            path.parent.mkdir(exist_ok=True)
            path.write_text(_checked_text(expand_home(word), group, model), encoding="utf-8")
        yield [options.get(override, override) for override in overrides], [Path(folder)]


def _split(override: str, model: type[Config]) -> tuple[str, str] | None:
    """Return the group and the file of an override `group=FILE`; None for another override."""
    group, _, value = override.lstrip("+").partition("=")
    word = value.strip().strip("'\"")
    return (group, word) if group in model.from_files and names_file(word) else None


def _checked_text(path: Path, group: str, model: type[Config]) -> str:
    """Read a file of a section; return its values as the text of a file of the config group."""
    import yaml

    if not os.path.exists(path):  # `Path.exists` raises for a name that is too long
        raise InputError(f"{group}: there is no file {path}")
    plain, _ = read_stored(path)
    try:
        typed(bare_type(model.model_fields[group].annotation), plain)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return str(yaml.safe_dump(plain, sort_keys=False))
