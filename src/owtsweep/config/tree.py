"""A folder of YAML files from which a configuration is composed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from owtsweep.config.common import Config

#: The folder conf/studies/<name>/ holds trees of further studies; it is not a config group.
TREES = "studies"


@dataclass(frozen=True)
class Tree:
    """A folder of YAML files from which Hydra composes a configuration.

    Attributes
    ----------
    folder
        The path of the folder.
    primary
        The name, without .yaml, of the file in `folder` with which Hydra begins.
    model
        The pydantic model of the configuration, from which error messages take the names of keys.
    """

    folder: Path
    primary: str
    model: type[Config]

    def groups(self) -> list[str]:
        """Return the sorted names of the config groups, i.e. of the subfolders of `folder`."""
        folders = (path.name for path in self.folder.iterdir() if path.is_dir())
        return sorted(name for name in folders if name != TREES)

    def options(self, group: str) -> list[str]:
        """Return the options of a config group: the sorted names of its files, without .yaml."""
        return sorted(path.stem for path in (self.folder / group).glob("*.yaml"))
