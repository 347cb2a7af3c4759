"""A study's configuration: composed from its tree, typed by its model, checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from owtsweep.config import Config, Tree, checked, compose_plain, require
from owtsweep.config.stored import read, resolved
from owtsweep.errors import InputError
from owtsweep.studies import registry


@dataclass(frozen=True)
class Located:
    """What overrides are composed from.

    Attributes
    ----------
    study
        The study that they name, or None: then the tree says which it is.
    tree
        The study's tree.
    overrides
        What Hydra gets: they do not name the study.
    """

    study: str | None
    tree: Tree
    overrides: list[str]


def locate(overrides: Sequence[str], *, primary: str = "sweep") -> Located:
    """Find the tree that overrides belong to.

    Raises
    ------
    InputError
        If they name several studies, one that there is not, or one that is not run by the command
        whose tree begins with `primary`.
    """
    name, others = _take_out_study(overrides)
    if name is None:
        tree = registry.find_tree(_default(primary))
        return Located(None, tree, tree.admit(others))
    entry = registry.find_entry(name)
    _check_command(name, primary)
    given = {_key(other) for other in others}
    implied = [override for override in entry.implied if _key(override) not in given]
    tree = registry.find_tree(name)
    return Located(name, tree, [*implied, *tree.admit(others)])


def compose(
    overrides: Sequence[str], config_dir: str | None = None, *, primary: str = "sweep"
) -> Config:
    """Compose, type and check a configuration.

    Parameters
    ----------
    overrides
        Hydra overrides, e.g. `["grid.replicates=2", "tuning=matched"]`; `study=NAME` among them
        says whose tree is composed, the hub's without it.
    config_dir
        A folder whose groups are found besides the tree's own (`--config-dir`).
    primary
        The file of the tree to begin with: "sweep" or "replay".

    Raises
    ------
    InputError
        With one line, for anything that is wrong in it.
    """
    located = locate(overrides, primary=primary)
    plain = compose_plain(located.tree, located.overrides, config_dir)
    study = str(plain.get("study", located.study or registry.DEFAULT))
    require(
        located.study in (None, study),
        f"study: {located.study!r} is named, but its files or another override say {study!r}; "
        "leave one out",
    )
    _check_command(study, primary)
    return _checked(plain, study)


def from_mapping(mapping: Any, study: str | None = None) -> Config:
    """Type and check a composed configuration, or one read back, by its study's model.

    Parameters
    ----------
    study
        The study's name; without it the mapping names it.

    Raises
    ------
    InputError
        For an unknown study, unknown keys (with the nearest known one), wrong types and impossible
        values.
    """
    return _checked(resolved(mapping), study)


def load_config(path: Path) -> Config:
    """Read a run's config.yaml.

    Raises
    ------
    InputError
        If it is missing, is no configuration of this program, or is of a study that is not
        installed.
    """
    plain = read(path)
    try:
        return _checked(plain)
    except InputError as error:
        study = str(plain.get("study", registry.DEFAULT))
        if study not in registry.names():
            raise InputError(
                f"{path}: the study {study!r} of this run is not installed; install its package "
                f"(there are {', '.join(registry.names())})"
            ) from error
        raise InputError(f"{path}: {error}") from error


def _checked(plain: dict[str, Any], study: str | None = None) -> Config:
    name = study or str(plain.get("study", registry.DEFAULT))
    return checked(registry.get_study(name).config_type(), {**plain, "study": name})


def _default(primary: str) -> str:
    """The study whose tree begins with a file: that of the command, or the hub."""
    return next(name for name, entry in registry.OURS.items() if entry.primary == primary)


def _check_command(study: str, primary: str) -> None:
    """Refuse a study that another command runs: its tree begins with another file."""
    needed = registry.find_entry(study).primary
    if needed == primary:
        return
    if primary == "sweep":
        raise InputError(f"study: {study!r} needs records; use `python -m owtsweep {needed} FILE`")
    raise InputError(f"study: {study!r} replays no record; leave it out")


def _key(override: str) -> str:
    return override.lstrip("+~").partition("=")[0]


def _take_out_study(overrides: Sequence[str]) -> tuple[str | None, list[str]]:
    """The study that the overrides name, and the other overrides; Hydra never sees `study=`."""
    require(
        not isinstance(overrides, str),
        f"overrides: {overrides!r} is one text; give a list, e.g. ['tuning=matched']",
    )
    name, others = None, []
    for override in overrides:
        key, _, value = override.partition("=")
        if key.lstrip("+~") != "study":
            others.append(override)
            continue
        require(
            key == "study" and value != "",
            f"{override}: name a study, e.g. study={registry.DEFAULT}",
        )
        require("," not in value, f"study: {value!r} are several studies; run one at a time")
        name = value.strip("'\"")
        registry.find_entry(name)
    return name, others
