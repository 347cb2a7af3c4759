"""Find a study by name, ours or another package's, and make its configuration.

A package adds a study called "blade" by two lines in its pyproject.toml,

    [project.entry-points."owtsweep.studies"]
    blade = "blade_study:BladeStudy"

and by YAML files for Hydra in the folder `conf` beside the module blade_study. The main YAML file
is sweep.yaml. A configuration is composed of these files, converted to a study's types, and
checked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import NamedTuple

from owtsweep.config import Config, Plain, admit, checked, compose_plain, conf_directory, require
from owtsweep.config.common import TREES, Tree
from owtsweep.config.hints import suggest_name
from owtsweep.errors import InputError, as_text
from owtsweep.sweep.study import Study, broken_study

#: The entry-point group of other packages' studies.
GROUP = "owtsweep.studies"

#: The study of a configuration that does not name one.
DEFAULT = "hub"


@dataclass(frozen=True)
class Entry:
    """How to find and run a study.

    target: the study's class as "module:Class", which is called without arguments.
    primary: Name of the study's main YAML file, without suffix, and of the subcommand that runs it.
    package: the distribution that contains the study; "" for a built-in study.
    """

    target: str
    primary: str = "sweep"
    package: str = ""


#: The built-in studies. A study without the folder conf/studies/<name> uses the YAML files in conf.
OURS = {
    "hub": Entry("owtsweep.studies.hub.study:HubStudy"),
    "replay": Entry("owtsweep.studies.replay:ReplayStudy", primary="replay"),
    "tower": Entry("owtsweep.studies.tower:TowerStudy"),
    "floater": Entry("owtsweep.studies.floater:FloaterStudy"),
    "blade": Entry("owtsweep.studies.blade:BladeStudy"),
    "mating": Entry("owtsweep.studies.mating:MatingStudy"),
}


def names() -> list[str]:
    """Return the names of all studies: built-in studies first, then those of other packages."""
    return [*OURS, *sorted({name for name, _ in _of_others()})]


def find_entry(name: str) -> Entry:
    """Return the entry of the study called `name`.

    Raise `InputError` if there is no study of this name; the message lists the known names, the
    most similar name first, or if several packages have a study of this name; the message lists the
    packages.
    """
    if name in OURS:
        return OURS[name]
    entries = [entry for other, entry in _of_others() if other == name]
    if not entries:
        raise InputError(f"study: there is no study {name!r}; {suggest_name(name, names())}")
    packages = " and ".join(entry.package for entry in entries)
    one = len(entries) == 1
    require(one, f"study: {name!r} is in the packages {packages}; uninstall all but one")
    return entries[0]


def get_study(name: str) -> Study:
    """Import the study called `name`, and return an object of its class; import no other study.

    Raise `InputError` if there is no study of this name, or if a study of another package does not
    work; the message names the package.
    """
    entry = find_entry(name)
    module, _, attribute = entry.target.partition(":")
    with blame_package(name):
        study = getattr(import_module(module), attribute)()
        require(isinstance(study, Study), f"{attribute} is no subclass of Study")
        require(study.name == name, f"the study's `name` is {study.name!r}")
        require(
            issubclass(study.config_type(), Config), "config_type() returns no subclass of Config"
        )
    return study  # type: ignore[no-any-return]


def list_schemes(name: str) -> Mapping[str, str]:
    """Return name -> description of the schemes of the study called `name`; {} if it has none."""
    return get_study(name).schemes()


def list_simplicity(name: str) -> Mapping[str, int]:
    """Return name -> simplicity of the schemes of the study called `name`; {} if it says none."""
    return get_study(name).list_simplicity()


def list_serving(command: str) -> str:
    """Return the studies for which a command of `Study.commands` works, in words.

    A study of another package that does not work is left out.
    """
    serving = []
    for name in names():
        with suppress(InputError):
            if command in get_study(name).commands:
                serving.append(name)
    return ", ".join(serving)


@contextmanager
def blame_package(name: str) -> Iterator[None]:
    """Turn any error inside the context into one line that names the package of a study.

    Errors of a built-in study are raised unchanged. Raise `InputError` if an error is raised inside
    the context and the study is of another package.
    """
    try:
        yield
    except (Exception, SystemExit) as error:
        package = find_entry(name).package
        if not package:
            raise
        reason = str(error) if isinstance(error, InputError) else as_text(error)
        raise broken_study(name, package, reason) from error


def _of_others() -> list[tuple[str, Entry]]:
    """Return each study of another package, but not one with the name of a built-in study."""
    return [
        (point.name, Entry(point.value, package=point.dist.name if point.dist else point.value))
        for point in entry_points(group=GROUP)
        if point.name not in OURS
    ]


def find_tree(name: str) -> Tree:
    """Return the folder of YAML files of the study called `name`.

    Raise `InputError` if there is no study of this name, or the study does not work, or if a study
    of another package lacks its main YAML file.
    """
    entry, model = find_entry(name), get_study(name).config_type()
    if entry.package:
        module = import_module(entry.target.partition(":")[0])
        folder = Path(str(module.__file__)).resolve().parent / "conf"
        require(
            (folder / f"{entry.primary}.yaml").is_file(),
            f"study: {name!r} of the package {entry.package} has no {folder}/{entry.primary}.yaml",
        )
        return Tree(folder, entry.primary, model)
    folder = conf_directory() / TREES / name
    return Tree(folder if folder.is_dir() else conf_directory(), entry.primary, model)


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
    if name is not None:
        _check_command(name, primary)
    tree = find_tree(name or next(n for n, entry in OURS.items() if entry.primary == primary))
    return Located(name, tree, admit(tree, others))


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
    study = str(plain.get("study", located.study or DEFAULT))
    require(
        located.study in (None, study),
        f"study: {located.study!r} is named, but the study's files or another override name "
        f"{study!r}; name only one study",
    )
    _check_command(study, primary)
    return make_config(plain, study)


def make_config(plain: Plain, study: str) -> Config:
    """Return the configuration of a study, with types converted and values checked.

    Raise `InputError` for an unknown study, an unknown key (the message suggests the nearest known
    one), a wrong type or an impossible value.
    """
    chosen = get_study(study)
    config: Config = checked(chosen.config_type(), chosen.complete({**plain, "study": study}))
    chosen.check(config)
    chosen.check_over(config)
    chosen.check_outside(config)
    return config


def _check_command(study: str, primary: str) -> None:
    """Raise `InputError` if another command runs the study: its main YAML file is not `primary`."""
    needed = find_entry(study).primary
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
            f"{override}: name a study, e.g. study={DEFAULT}",
        )
        require("," not in value, f"study: {value!r} are several studies; run one at a time")
        name = value.strip("'\"")
        find_entry(name)
    return name, others
