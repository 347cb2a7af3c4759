"""Studies by name: ours, and those of other packages by the entry-point group `owtsweep.studies`.

A package adds a study by two lines in its pyproject.toml,

    [project.entry-points."owtsweep.studies"]
    tower = "tower_study:TowerStudy"

and its Hydra tree in the folder `conf` beside that module, with the file sweep.yaml to begin with.
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

#: The study of a configuration that names none.
DEFAULT = "hub"


@dataclass(frozen=True)
class Entry:
    """Where a study is found.

    Attributes
    ----------
    target
        "module:Class"; the class is made without arguments.
    primary
        The file of its tree to begin with; one that is not "sweep" has a subcommand of that name.
    implied
        Overrides without which the tree does not give this study.
    package
        The distribution of a third party's study; "" for ours.
    """

    target: str
    primary: str = "sweep"
    implied: tuple[str, ...] = ()
    package: str = ""


#: Our studies. One whose tree is not conf/studies/<name> builds on the hub's.
OURS = {
    "hub": Entry("owtsweep.studies.hub:HubStudy"),
    "readings": Entry("owtsweep.studies.readings:ReadingsStudy", implied=("experiment=readings",)),
    "replay": Entry("owtsweep.studies.replay:ReplayStudy", primary="replay"),
}


def names() -> list[str]:
    """The names of all studies: ours first, then those of other packages."""
    return [*OURS, *sorted(_of_others())]


def find_entry(name: str) -> Entry:
    """Where the study of that name is found.

    Raises
    ------
    InputError
        If there is none, with the nearest name and all others; or if several packages have one.
    """
    if name in OURS:
        return OURS[name]
    others = _of_others()
    if name not in others:
        hint = suggest_name(name, [*OURS, *sorted(others)])
        raise InputError(f"study: there is no study {name!r}; {hint}")
    first, *more = others[name]
    packages = " and ".join(entry.package for entry in others[name])
    require(not more, f"study: {name!r} is in the packages {packages}; uninstall all but one")
    return first


def get_study(name: str) -> Study:
    """The study of that name; only what it needs is imported.

    Raises
    ------
    InputError
        If there is no such study, or another package's does not work; with the package's name.
    """
    entry = find_entry(name)
    module, _, attribute = entry.target.partition(":")
    with blame_package(name):
        study = getattr(import_module(module), attribute)()
        lacks = _lacks(study)
        require(not lacks, f"it lacks {', '.join(lacks)}")
        require(study.name == name, f"it calls itself {study.name!r}")
        if entry.package:
            require(issubclass(study.config_type(), Config), "its configuration is no Config")
    return study  # type: ignore[no-any-return]


@contextmanager
def blame_package(name: str) -> Iterator[None]:
    """Turn whatever the code of another package's study raises into one line with its package.

    Raises
    ------
    InputError
        Instead of any error within; errors of our own studies stay as they are.
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


def _of_others() -> dict[str, list[Entry]]:
    """The studies of other packages; a name of ours stays ours."""
    others: dict[str, list[Entry]] = {}
    for point in entry_points(group=GROUP):
        if point.name not in OURS:
            package = point.dist.name if point.dist else point.value
            others.setdefault(point.name, []).append(Entry(point.value, package=package))
    return others


def _lacks(study: Any) -> list[str]:
    """What of the protocol `Study` an object does not have."""
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
