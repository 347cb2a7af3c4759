"""Find studies by name: built-in ones, and entry points `owtsweep.studies` of other packages.

A package adds a study with two lines in its pyproject.toml,

    [project.entry-points."owtsweep.studies"]
    tower = "tower_study:TowerStudy"

and a Hydra tree in the folder `conf` beside that module. Its primary file is sweep.yaml.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from owtsweep.config import Config, Tree, conf_directory, require
from owtsweep.config.composition import TREES
from owtsweep.config.hints import suggest_name
from owtsweep.errors import InputError, as_text
from owtsweep.sweep.study import Study

#: The entry-point group of other packages' studies.
GROUP = "owtsweep.studies"

#: The study of a configuration that does not name one.
DEFAULT = "hub"


@dataclass(frozen=True)
class Entry:
    """How to find a study.

    Attributes
    ----------
    target
        "module:Class"; the class is called without arguments.
    primary
        The primary file of its tree; if it is not "sweep", the subcommand of that name runs it.
    implied
        Overrides that select this study in its tree.
    package
        The distribution that contains the study; "" for a built-in study.
    """

    target: str
    primary: str = "sweep"
    implied: tuple[str, ...] = ()
    package: str = ""


#: The built-in studies. A study without the folder conf/studies/<name> uses the tree of the hub.
OURS = {
    "hub": Entry("owtsweep.studies.hub:HubStudy"),
    "readings": Entry("owtsweep.studies.readings:ReadingsStudy", implied=("experiment=readings",)),
    "replay": Entry("owtsweep.studies.replay:ReplayStudy", primary="replay"),
}


def names() -> list[str]:
    """The names of all studies: built-in ones first, then those of other packages."""
    return [*OURS, *sorted({name for name, _ in _of_others()})]


def find_entry(name: str) -> Entry:
    """The entry of the study of that name.

    Raises
    ------
    InputError
        If there is none (with the nearest name and all names), or if several packages have one.
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
    """The study of that name; only what it needs is imported.

    Raises
    ------
    InputError
        If there is no such study, or if a study of another package does not work; the message
        names the package.
    """
    entry = find_entry(name)
    module, _, attribute = entry.target.partition(":")
    with blame_package(name):
        study = getattr(import_module(module), attribute)()
        lacks = _lacks(study)
        require(not lacks, f"it lacks {', '.join(lacks)}")
        require(study.name == name, f"it calls itself {study.name!r}")
        require(issubclass(study.config_type(), Config), "its configuration is no Config")
    return study  # type: ignore[no-any-return]


@contextmanager
def blame_package(name: str) -> Iterator[None]:
    """Turn any error in a study of another package into one line that names the package.

    Raises
    ------
    InputError
        Instead of any error inside the context; errors of built-in studies are not changed.
    """
    try:
        yield
    except (Exception, SystemExit) as error:
        package = find_entry(name).package
        if not package:
            raise
        reason = str(error) if isinstance(error, InputError) else as_text(error)
        raise InputError(
            f"study: {name!r} of the package {package} does not work ({reason}); "
            "update or uninstall that package"
        ) from error


def _of_others() -> list[tuple[str, Entry]]:
    """Names and entries of other packages' studies, without those named like a built-in study."""
    return [
        (point.name, Entry(point.value, package=point.dist.name if point.dist else point.value))
        for point in entry_points(group=GROUP)
        if point.name not in OURS
    ]


def _lacks(study: Any) -> list[str]:
    """The members of the protocol `Study` that an object lacks."""
    protocol = {*Study.__annotations__, *(n for n in vars(Study) if not n.startswith("_"))}
    return sorted(member for member in protocol if not hasattr(study, member))


def find_tree(name: str) -> Tree:
    """The Hydra tree of a study.

    Raises
    ------
    InputError
        As `get_study`, or if the study has no tree.
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
