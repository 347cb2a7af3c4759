"""Check the user's own YAML files (`--config-dir`) before Hydra reads them.

The user trusts these files, so they may hold interpolations and aliases. But a typing error must
not end in a traceback, and aliases of aliases must not stand for more data than fit into memory.
This module imports Hydra, so it is imported only if there is such a folder.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import yaml
from hydra._internal.core_plugins.file_config_source import FileConfigSource
from hydra._internal.sources_registry import SourcesRegistry
from hydra.plugins.config_source import ConfigResult

from owtsweep.config.stored import DEEPEST, MOST_BYTES
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text

#: A file may hold at most this many values, counted after its aliases have been replaced.
MOST_VALUES = 1_000_000


class CheckedFiles(FileConfigSource):
    """A folder on Hydra's search path, `checked://<folder>`, whose files are checked when read."""

    @staticmethod
    def scheme() -> str:
        return "checked"

    def load_config(self, config_path: str) -> ConfigResult:
        """Read a file, e.g. `tuning/mine`.

        Raise `InputError` if the file cannot be read, is no YAML, nests too deeply, or holds too
        many values.
        """
        _check_file(Path(self.path, self._normalize_file_name(config_path)))
        return super().load_config(config_path)


def search_path_of(directories: Sequence[Path]) -> str:
    """Return the override by which Hydra finds groups in these folders too, and checks the files.

    If several folders have a file of the same group and name, Hydra takes that of the first.
    """
    SourcesRegistry.instance().register(CheckedFiles)  # does nothing the second time
    quoted = [str(path).replace("\\", "\\\\").replace("'", "\\'") for path in directories]
    places = ",".join(f"'{CheckedFiles.scheme()}://{path}'" for path in quoted)
    return f"hydra.searchpath=[{places}]"


def _check_file(path: Path) -> None:
    text = read_text(path, MOST_BYTES)
    try:
        deepest, values = _measure(text)
    except yaml.YAMLError as error:
        raise InputError(f"{path}: this is no YAML ({' '.join(str(error).split())})") from None
    require(deepest <= DEEPEST, f"{path}: its lists and mappings lie more than {DEEPEST} deep")
    require(
        values <= MOST_VALUES,
        f"{path}: its aliases (*name) stand for more than {MOST_VALUES} values; write fewer",
    )


def _measure(text: str) -> tuple[int, int]:
    """Return the depth of a YAML text, e.g. 3 for `a: {b: [1]}`, and the number of its values.

    An alias (`*name`) counts as the values for which it stands. Counting stops as soon as a bound,
    `DEEPEST` or `MOST_VALUES`, is exceeded.
    """
    deepest = 0
    sizes: dict[str | None, int] = {}  # anchor -> number of values that it names
    open_lists: list[tuple[str | None, int]] = []  # anchor, and `values` at its start
    values = 0
    for event in yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
        if isinstance(event, yaml.AliasEvent):
            values += sizes.get(event.anchor, MOST_VALUES)  # unfinished: it holds itself
        elif isinstance(event, yaml.ScalarEvent):
            values += 1
            sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionStartEvent):
            open_lists.append((event.anchor, values))
            sizes.pop(event.anchor, None)
            deepest = max(deepest, len(open_lists))
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_lists.pop()
            values += 1
            sizes[anchor] = values - before
        if deepest > DEEPEST or values > MOST_VALUES:
            break
    return deepest, values
