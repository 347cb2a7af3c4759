"""config.yaml: all keys of a run's configuration."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

from owtsweep.config.common import Config
from owtsweep.config.hydra_errors import hydra_in_one_line
from owtsweep.config.typed import as_plain, checked
from owtsweep.errors import InputError

C = TypeVar("C", bound=Config)


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


def load(path: Path, model: type[C]) -> C:
    """Read a config.yaml of a study whose model is given.

    Raises
    ------
    InputError
        As `read` and `checked`; the message names the file.
    """
    plain = read(path)
    try:
        return checked(model, plain)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


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
