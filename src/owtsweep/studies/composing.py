"""Make the configuration of a study: compose the study's YAML files, type the keys, check them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from owtsweep.config import Config, Tree, checked, compose_plain, require
from owtsweep.config.stored import resolved
from owtsweep.errors import InputError
from owtsweep.studies import registry


class Located(NamedTuple):
    """The study, tree and overrides that a configuration is composed from.

    Attributes
    ----------
    study
        The study that the overrides name; None if they name none, so that the tree names it.
    tree
        The YAML files of the study.
    overrides
        The overrides for Hydra, without `study=NAME`.
    """

    study: str | None
    tree: Tree
    overrides: list[str]


def locate(overrides: Sequence[str], *, primary: str = "sweep") -> Located:
    """Find the study that overrides name, the study's tree of YAML files, and Hydra's overrides.

    `primary` is the name of the tree's primary file: "sweep" or "replay".

    Raises
    ------
    InputError
        If the overrides name several studies, an unknown study, or a study that another command
        runs because its primary file is not `primary`.
    """
    name, others = _take_out_study(overrides)
    if name is None:
        default = next(n for n, entry in registry.OURS.items() if entry.primary == primary)
        tree = registry.find_tree(default)
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
        Hydra overrides, e.g. `["grid.replicates=2", "tuning=matched"]`. `study=NAME` among them
        selects the study whose tree is composed; without it, the first built-in study whose
        primary file is `primary` is taken ("hub" for "sweep").
    config_dir
        A folder with further config groups (`--config-dir`).
    primary
        The primary file of the tree: "sweep" or "replay".

    Raises
    ------
    InputError
        If anything is wrong with the overrides or files; the message is one line.
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
    """Type and check a composed or stored configuration with the model of its study.

    Parameters
    ----------
    mapping
        An OmegaConf object.
    study
        The study's name; None takes the value of the mapping's key `study`, or else "hub".

    Raises
    ------
    InputError
        For an unknown study, unknown keys (with the nearest known one), wrong types and impossible
        values.
    """
    return _checked(resolved(mapping), study)


def _checked(plain: dict[str, Any], study: str | None = None) -> Config:
    name = study or str(plain.get("study", registry.DEFAULT))
    model = registry.get_study(name).config_type()
    return checked(model, model.complete({**plain, "study": name}))


def _check_command(study: str, primary: str) -> None:
    """Raise `InputError` if a study's primary file is not `primary`: another command runs it."""
    needed = registry.find_entry(study).primary
    if needed == primary:
        return
    if primary == "sweep":
        raise InputError(f"study: {study!r} needs records; use `python -m owtsweep {needed} FILE`")
    raise InputError(f"study: {study!r} replays no record; leave it out")


def _key(override: str) -> str:
    return override.lstrip("+~").partition("=")[0]


def _take_out_study(overrides: Sequence[str]) -> tuple[str | None, list[str]]:
    """Return the name of the study that the overrides name, and the other overrides.

    The name is None if no override is `study=NAME`.

    Raises
    ------
    InputError
        If the overrides are one text, or name an unknown study or several studies.
    """
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
