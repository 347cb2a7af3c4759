"""Write and read config.yaml, which holds all keys of a run's configuration.

A run folder may be another person's, so a stored configuration is read with care: it may hold only
values, no interpolations and no aliases.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import Any

from owtsweep.config.common import Config
from owtsweep.config.hydra_errors import hydra_in_one_line
from owtsweep.config.typed import as_plain
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text

#: Most bytes of a stored configuration. The largest grid needs a hundredth of this.
MOST_BYTES = 10_000_000
#: The lists and mappings of a stored configuration may be nested at most this deep.
DEEPEST = 20


def dump(config: Config) -> str:
    """Return a configuration as YAML text."""
    from omegaconf import OmegaConf

    return OmegaConf.to_yaml(OmegaConf.create(as_plain(config)))


def read(path: Path, *, resolve: bool = True) -> dict[str, Any]:
    """Return the plain data of a YAML file; `resolve` replaces interpolations by their values.

    Raises
    ------
    InputError
        If the file is missing, or does not hold a mapping of keys.
    """
    from omegaconf import OmegaConf

    with _naming(path):
        return resolved(OmegaConf.load(path), resolve=resolve)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Turn any error of reading YAML into an InputError of one line that names the file."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except Exception as error:  # the errors of the YAML library have no common base class
        text = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a configuration ({text})") from error


def read_stored(path: Path) -> tuple[dict[str, Any], str]:
    """Return the plain data of a stored config.yaml, and the text of the file.

    Raises
    ------
    InputError
        If the path is missing or no file, or the file is too large, is not a mapping of keys, or
        holds an interpolation or an alias. An interpolation (`${...}`) could read this user's
        environment. An alias (`*name`) can stand for more data than fit into memory.
    """
    from omegaconf import OmegaConf

    text = read_text(path, MOST_BYTES)
    with _naming(path):
        _check_events(text)
        plain = resolved(OmegaConf.load(StringIO(text)), resolve=False)
    require(
        not any("${" in word for word in _texts(plain)),
        f"{path}: it holds an interpolation (${{...}}); a stored configuration holds values",
    )
    return plain, text


def _check_events(text: str) -> None:
    """Raise `InputError` if a YAML text has an alias or nests too deeply, before it is loaded."""
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
    """Yield all texts in plain data, including the keys of mappings."""
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
    """Return the plain data of an OmegaConf object; `resolve` replaces interpolations by values.

    Raises
    ------
    InputError
        If the object is not a mapping, or an interpolation to be replaced names a missing key.
    """
    from omegaconf import OmegaConf

    with hydra_in_one_line():
        plain = OmegaConf.to_container(mapping, resolve=resolve)
    if not isinstance(plain, dict):
        raise InputError("config: this is a list, not a mapping of keys")
    return {str(key): value for key, value in plain.items()}
