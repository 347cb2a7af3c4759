"""Check the user's own YAML files (option `--config-dir`) before Hydra reads them.

The user trusts these files, so interpolations (`${...}`) and aliases (`*name`) are allowed. But a
typing error in a file must not end in a traceback, and aliases of aliases must not stand for more
data than fit into memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from owtsweep.config.stored import DEEPEST, MOST_BYTES
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text

#: A file may hold at most this many values, counted after its aliases have been replaced.
MOST_VALUES = 1_000_000


def check_chosen_files(directory: Path, overrides: Sequence[str]) -> None:
    """Check the YAML files that overrides choose from the user's folder of config groups.

    For example, the override `tuning=mine` chooses the file tuning/mine.yaml in `directory`. If
    `directory` does not hold the chosen file, nothing is checked.

    Raises
    ------
    InputError
        If a file cannot be read or is no YAML, its lists and mappings lie too deep in each other,
        or its aliases stand for too many values.
    """
    for override in overrides:
        group, _, options = override.lstrip("+").partition("=")
        for option in options.strip("[]").split(","):
            path = directory / group.partition("@")[0] / f"{option.strip(' ')}.yaml"
            if len(option) < 100 and path.is_file():
                _check_file(path)


def _check_file(path: Path) -> None:
    import yaml

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
    """Return the depth of a YAML text, and the number of its values.

    The depth is the largest number of nested lists and mappings, e.g. 3 for `a: {b: [1]}`. In the
    number of values, an alias (`*name`) counts as the values for which the alias stands. Counting
    stops as soon as the depth exceeds `DEEPEST` or the number exceeds `MOST_VALUES`.
    """
    import yaml

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
