"""config.yaml: all keys of a run's configuration, as the program writes it and as others may.

A run folder may be another person's. So a stored configuration is read with care: it is resolved
data and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any

from owtsweep.config.common import Config
from owtsweep.config.hydra_errors import hydra_in_one_line
from owtsweep.config.typed import as_plain
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text

#: Most bytes of a stored configuration: the largest grid fits a hundred times.
MOST_BYTES = 10_000_000
#: How deep lists and mappings of a stored configuration may lie in each other.
DEEPEST = 20


def dump(config: Config) -> str:
    """The configuration as YAML."""
    from omegaconf import OmegaConf

    return OmegaConf.to_yaml(OmegaConf.create(as_plain(config)))


def read(path: Path, *, resolve: bool = True) -> dict[str, Any]:
    """The plain data of a YAML file; with `resolve`, interpolations are replaced by their values.

    Raises
    ------
    InputError
        If it is missing or does not hold a mapping of keys.
    """
    from omegaconf import OmegaConf

    try:
        return resolved(OmegaConf.load(path), resolve=resolve)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except Exception as error:  # the errors of the YAML library have no common base class
        text = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a configuration ({text})") from error


def read_stored(path: Path) -> tuple[dict[str, Any], str]:
    """The plain data of a stored config.yaml, and its text.

    Raises
    ------
    InputError
        If it is missing, no file, too large, not a mapping of keys, or not resolved: an
        interpolation (`${...}`) would read this user's environment, and an alias (`*name`) can
        stand for more data than fit into memory.
    """
    from omegaconf import OmegaConf

    text = read_text(path, MOST_BYTES)
    try:
        _check_events(text)
        plain = resolved(OmegaConf.load(StringIO(text)), resolve=False)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except Exception as error:  # the errors of the YAML library have no common base class
        words = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a configuration ({words})") from error
    require(
        not any("${" in word for word in _texts(plain)),
        f"{path}: it holds an interpolation (${{...}}); a stored configuration holds values",
    )
    return plain, text


def _check_events(text: str) -> None:
    """Refuse YAML that grows or nests without bounds, before any of it is made."""
    import yaml

    depth = 0
    for event in yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
        require(
            not isinstance(event, yaml.AliasEvent),
            "it holds an alias (*name); a stored configuration holds values",
        )
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        require(depth <= DEEPEST, f"its lists and mappings lie more than {DEEPEST} deep")


def _texts(value: Any) -> Iterator[str]:
    """All texts in plain data, keys included."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from _texts(name)
            yield from _texts(item)
    elif isinstance(value, list):
        for item in value:
            yield from _texts(item)


def resolved(mapping: Any, *, resolve: bool = True) -> dict[str, Any]:
    """The plain data of an OmegaConf object; `resolve` replaces interpolations.

    Raises
    ------
    InputError
        If it is not a mapping, or an interpolation names a key that is missing.
    """
    from omegaconf import OmegaConf

    with hydra_in_one_line():
        plain = OmegaConf.to_container(mapping, resolve=resolve)
    if not isinstance(plain, dict):
        raise InputError("config: this is a list, not a mapping of keys")
    return {str(key): value for key, value in plain.items()}
