"""Make a study's configuration: compose its YAML files with Hydra, convert types, check values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from owtsweep.config import Config, Tree, admit, checked, compose_plain, require
from owtsweep.config.stored import resolved
from owtsweep.errors import InputError
from owtsweep.studies import registry


class Located(NamedTuple):
    """What a configuration is composed from: study, YAML files and overrides.

    study: Name that an override `study=NAME` gives. None: the YAML files name the study.
    tree: the study's folder of YAML files.
    overrides: the overrides for Hydra, without `study=NAME`.
    """

    study: str | None
    tree: Tree
    overrides: list[str]


def locate(overrides: Sequence[str], *, primary: str = "sweep") -> Located:
    """Find the study and its YAML files; separate `study=NAME` from the overrides for Hydra.

    If no override is `study=NAME`, the result names no study. It then has the YAML files of the
    first built-in study whose main file is `primary`: "sweep" or "replay", by the command. Raise
    `InputError` if the overrides name several studies, an unknown study, or a study whose main YAML
    file is not `primary`, so that another command runs the study.
    """
    name, others = _take_out_study(overrides)
    if name is None:
        default = next(n for n, entry in registry.OURS.items() if entry.primary == primary)
        tree = registry.find_tree(default)
        return Located(None, tree, admit(tree, others))
    entry = registry.find_entry(name)
    _check_command(name, primary)
    given = {_key(other) for other in others}
    implied = [override for override in entry.implied if _key(override) not in given]
    tree = registry.find_tree(name)
    return Located(name, tree, [*implied, *admit(tree, others)])


def compose(
    overrides: Sequence[str], config_dir: str | None = None, *, primary: str = "sweep"
) -> Config:
    """Compose a study's configuration from YAML files and overrides; convert types, check values.

    Raise `InputError` if anything is wrong with the overrides or files; the message is one line.

    overrides: Hydra overrides, e.g. `["grid.replicates=2", "tuning=matched"]`. `study=NAME` selects
        the study. Without it, the first built-in study whose main YAML file is `primary` is taken
        ("hub" for "sweep").
    config_dir: a folder with further config groups for Hydra (`--config-dir`).
    primary: Name of the main YAML file: "sweep" or "replay".
    """
    located = locate(overrides, primary=primary)
    plain = compose_plain(located.tree, located.overrides, config_dir)
    study = str(plain.get("study", located.study or registry.DEFAULT))
    require(
        located.study in (None, study),
        f"study: {located.study!r} is named, but the study's files or another override name "
        f"{study!r}; name only one study",
    )
    _check_command(study, primary)
    return _checked(plain, study)


def from_mapping(mapping: Any, study: str | None = None) -> Config:
    """Return a composed or stored configuration with its types converted and its values checked.

    The model is that of `study`, or else of the mapping's key `study`, or of "hub".
    Raise `InputError` for an unknown study, an unknown key (the message suggests the nearest known
    one), a wrong type or an impossible value.
    """
    return _checked(resolved(mapping), study)


def _checked(plain: dict[str, Any], study: str | None = None) -> Config:
    name = study or str(plain.get("study", registry.DEFAULT))
    chosen = registry.get_study(name)
    config: Config = checked(chosen.config_type(), chosen.complete({**plain, "study": name}))
    chosen.check(config)
    chosen.check_outside(config)
    return config


def _check_command(study: str, primary: str) -> None:
    """Raise `InputError` if another command runs the study: its main YAML file is not `primary`."""
    needed = registry.find_entry(study).primary
    if needed == primary:
        return
    if primary == "sweep":
        raise InputError(f"study: {study!r} needs records; use `owtsweep {needed} FILE`")
    raise InputError(f"study: {study!r} replays no record; leave out study={study}")


def require_texts(overrides: Sequence[str]) -> None:
    """Raise `InputError` unless `overrides` is a list of texts: a caller may give anything."""
    require(
        not isinstance(overrides, str),
        f"overrides: {overrides!r} is one text; give a list of texts, e.g. ['tuning=matched']",
    )
    require(
        isinstance(overrides, Sequence) and all(isinstance(word, str) for word in overrides),
        f"overrides: {overrides!r} is no list of texts; give one, e.g. ['tuning=matched']",
    )


def _key(override: str) -> str:
    return override.lstrip("+~").partition("=")[0]


def _take_out_study(overrides: Sequence[str]) -> tuple[str | None, list[str]]:
    """Return the name of the study, if any, and the overrides without `study=NAME`.

    Raise `InputError` if `overrides` is no list of texts, or names an unknown study, several
    studies, or an empty name.
    """
    require_texts(overrides)
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
