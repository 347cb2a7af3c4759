"""Check the user's own YAML files (`--config-dir`) before Hydra reads them.

The user trusts these files, so they may hold interpolations and aliases. But a typing error must
not end in a traceback, and aliases of aliases must not stand for more data than fit into memory.
This module imports Hydra, so it is imported only if there is such a folder.
"""

from __future__ import annotations

from pathlib import Path

from hydra._internal.core_plugins.file_config_source import FileConfigSource
from hydra._internal.sources_registry import SourcesRegistry
from hydra.plugins.config_source import ConfigResult

from owtsweep.config.stored import MOST_BYTES, check_events, naming
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
        path = Path(self.path, self._normalize_file_name(config_path))
        text = read_text(path, MOST_BYTES)
        with naming(path):
            check_events(text, MOST_VALUES, aliases=True)
        return super().load_config(config_path)


def address_of(directory: Path) -> str:
    """Return the address by which Hydra finds groups in this folder too, and checks its files."""
    SourcesRegistry.instance().register(CheckedFiles)  # does nothing the second time
    return f"{CheckedFiles.scheme()}://{directory}"
