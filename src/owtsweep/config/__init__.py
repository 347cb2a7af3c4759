"""Configuration: what every study has, composed by Hydra, typed and checked once.

`compose` turns overrides into a frozen dataclass or raises `InputError` with one line. From then
on nobody looks at OmegaConf objects again.
"""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints

from owtsweep.errors import InputError

#: The version of the configuration's keys, stored in every run's config.yaml.
CONFIG_VERSION = 1

#: Old key -> hint. A renamed key is answered with its new name in one line.
RENAMED: dict[str, str] = {}

BACKENDS = ("auto", "threading", "loky", "dask")
ENGINES = ("batch", "reference", "expected")


@dataclass(frozen=True, kw_only=True)
class Compute:
    """How to compute: never changes a result, so never part of a key.

    `workers: 0` means all cores (of the cluster, with `backend: dask`); `backend: auto` leaves the
    choice to the study. `scheduler` is the address of a dask scheduler. `vectors: false` compiles
    kernels as plain loops: slower, the same bits (docs/vectors.md).
    """

    backend: str = "auto"
    workers: int = 0
    scheduler: str | None = None
    vectors: bool = True


@dataclass(frozen=True, kw_only=True)
class Config:
    """The keys that every study has."""

    study: str = "hub"
    experiment: str = "study"
    results: str = "results"
    name: str | None = None
    seed: int = 2019
    engine: str = "batch"
    config_version: int = CONFIG_VERSION
    compute: Compute = field(default_factory=Compute)

    def check(self) -> None:
        """Raise `InputError` for values that cannot work; studies extend it."""
        require(self.engine in ENGINES, f"engine: {self.engine!r} is none of {', '.join(ENGINES)}")
        require(
            self.compute.backend in BACKENDS,
            f"compute.backend: {self.compute.backend!r} is none of {', '.join(BACKENDS)}",
        )
        require(
            self.compute.workers >= 0,
            f"compute.workers: {self.compute.workers} is negative; use 0 for all cores",
        )
        self._check_scheduler()
        require(self.results.strip() != "", "results: it is empty; name a folder, e.g. results")
        require(self.seed >= 0, f"seed: {self.seed} is negative; use an integer >= 0")
        require(
            self.config_version == CONFIG_VERSION,
            f"config_version: {self.config_version} is not known; this version writes and reads "
            f"{CONFIG_VERSION}",
        )
        if self.name is not None:
            require(
                re.fullmatch(r"[\w.+=,-]+", self.name) is not None and self.name not in (".", ".."),
                f"name: {self.name!r} is no plain folder name; use letters, digits, . _ - + = ,",
            )

    def _check_scheduler(self) -> None:
        backend, scheduler = self.compute.backend, self.compute.scheduler
        if backend != "dask":
            require(
                scheduler is None,
                f"compute.scheduler: {scheduler!r} needs compute.backend=dask, not {backend}",
            )
            return
        require(
            scheduler is not None,
            "compute.scheduler: compute.backend=dask needs one; give tcp://host:port",
        )
        require(
            re.fullmatch(r"(tcp|tls)://(\[[^\]]+\]|[^:/\s]+):\d+", str(scheduler)) is not None,
            f"compute.scheduler: {scheduler!r} is no address; give tcp://host:port",
        )


def with_values(config: Any, values: Mapping[str, Any]) -> Any:
    """A copy of a configuration (or of a section) with some dotted keys set; types are kept.

    Raises
    ------
    InputError
        For a key that does not exist or a value of the wrong type.
    """
    hints = get_type_hints(type(config))
    changes: dict[str, Any] = {}
    for key, value in values.items():
        name, _, rest = key.partition(".")
        require(name in hints, f"{key}: there is no such key")
        current = changes.get(name, getattr(config, name))
        changes[name] = (
            with_values(current, {rest: value}) if rest else _typed(hints[name], value, key)
        )
    return dataclasses.replace(config, **changes)


def require(condition: bool, message: str) -> None:
    """Raise `InputError(message)` unless the condition holds."""
    if not condition:
        raise InputError(message)


#: Metadata of a key that is younger than stored runs: while it is unset it is no part of what
#: identifies a configuration, so that their keys and hashes stay.
YOUNGER = {"younger": True}


def as_mapping(config: Any) -> dict[str, Any]:
    """What identifies a configuration or a section, as plain dicts, lists and scalars."""
    mapping = dataclasses.asdict(config)
    _drop_unset(config, mapping)
    return mapping


def _drop_unset(config: Any, mapping: dict[str, Any]) -> None:
    for item in dataclasses.fields(config):
        value = getattr(config, item.name)
        if dataclasses.is_dataclass(value):
            _drop_unset(value, mapping[item.name])
        if item.metadata.get("younger") and mapping[item.name] in (None, {}):
            del mapping[item.name]


def conf_directory() -> Path:
    """The Hydra tree: inside the installed package, or beside src in an editable checkout."""
    package = Path(__file__).resolve().parents[1]
    for candidate in (package / "conf", package.parents[1] / "conf"):
        if (candidate / "sweep.yaml").is_file():
            return candidate
    raise InputError(f"conf: no sweep.yaml in {package / 'conf'}: the installation is incomplete")


def compose(
    overrides: Sequence[str], config_dir: str | None = None, *, primary: str = "sweep"
) -> Config:
    """Compose, type and check a configuration.

    Parameters
    ----------
    overrides
        Hydra overrides, e.g. `["grid.replicates=2", "tuning=matched"]`.
    config_dir
        A folder whose groups are found besides the package's own (`--config-dir`).
    primary
        The file of the Hydra tree to begin with: "sweep" or "replay".

    Raises
    ------
    InputError
        With one line, for anything that is wrong in it.
    """
    from hydra.errors import HydraException
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    from owtsweep.longlists import shortened

    require(
        not isinstance(overrides, str),
        f"overrides: {overrides!r} is one text; give a list, e.g. ['tuning=matched']",
    )
    for override in overrides:
        require(
            not override.lstrip("+~").startswith("hydra"),
            f"{override}: Hydra's own settings work with --multirun only",
        )
    search = []
    if config_dir is not None:
        directory = Path(config_dir).resolve()
        require(directory.is_dir(), f"--config-dir: {config_dir} is no folder")
        search = [f"hydra.searchpath=[file://{directory}]"]
    short, marks = shortened(overrides)
    if marks.lists:
        plain = None
        # whatever is wrong with it is told by the ordinary way
        with suppress(HydraException, OmegaConfBaseException, ValueError, TypeError):
            marked = _composed(primary, [*search, *short])
            plain = marks.back(OmegaConf.to_container(marked, resolve=True))
        if plain is not None:
            _check_study(str(plain.get("study")), primary)
            return _from_plain(plain)
    try:
        composed = _composed(primary, [*search, *overrides])
    except (ValueError, TypeError) as error:  # a number where Hydra expects an option's name
        groups = {path.name for path in conf_directory().iterdir() if path.is_dir()}
        wrong = [o for o in overrides if o.split("=")[0] in groups]
        if not wrong:
            text = " ".join(str(error).split())
            raise InputError(f"{' '.join(overrides)}: this cannot be composed ({text})") from error
        raise InputError(f"{wrong[0]}: this is a config group; name one of its options") from error
    except (HydraException, OmegaConfBaseException) as error:
        study = "replay" if primary == "replay" else "hub"
        raise InputError(one_line(error, study)) from error
    _check_study(str(composed.get("study")), primary)
    return from_mapping(composed)


def _composed(primary: str, overrides: list[str]) -> Any:
    from hydra import compose as hydra_compose
    from hydra import initialize_config_dir

    with initialize_config_dir(config_dir=str(conf_directory()), version_base="1.3"):
        return hydra_compose(primary, overrides=overrides)


def _check_study(study: str, primary: str) -> None:
    """Each file of the tree has its own keys; those of another study's would be missing."""
    if primary == "replay":
        require(study == "replay", f"study: {study!r} replays no record; leave it out")
    else:
        require(
            study != "replay",
            "study: 'replay' needs records; use `python -m owtsweep replay FILE`",
        )


def from_mapping(mapping: Any) -> Config:
    """Type and check a composed configuration, or one read back from config.yaml.

    Raises
    ------
    InputError
        For unknown keys (with the nearest known one), wrong types and impossible values.
    """
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    try:
        loaded = mapping if OmegaConf.is_config(mapping) else OmegaConf.create(dict(mapping))
        plain = OmegaConf.to_container(loaded, resolve=True)
    except OmegaConfBaseException as error:
        raise InputError(one_line(error)) from error
    if not isinstance(plain, dict):
        raise InputError("config: this is a list, not a mapping of keys")
    return _from_plain(plain)


def _from_plain(plain: dict[Any, Any]) -> Config:
    from owtsweep.studies import get_study

    study = get_study(str(plain.get("study", "hub")))
    config = _typed(study.config_type(), plain, "")
    if not isinstance(config, Config):  # the schema is a Config, so its object is one too
        raise TypeError(type(config))
    config.check()
    return config


def _typed(kind: Any, value: Any, key: str) -> Any:
    """`value` as an object of the annotated type `kind`, or an `InputError` that names the key."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind is Any:
        return value
    if origin is UnionType:  # X | None
        return None if value is None else _typed(arguments[0], value, key)
    if dataclasses.is_dataclass(kind):
        return _typed_section(kind, value, key)
    if origin is dict:
        require(isinstance(value, dict), f"{key}: {value!r} is no mapping of names")
        return value
    if origin is list:
        require(isinstance(value, list), f"{key}: {value!r} is no list; use e.g. {key}=[{value}]")
        return [_typed(arguments[0], item, f"{key}[{i}]") for i, item in enumerate(value)]
    try:
        if kind is bool and isinstance(value, bool):
            return value
        if kind is str and isinstance(value, str | int | float) and not isinstance(value, bool):
            return str(value)
        if kind is int and not isinstance(value, bool) and int(value) == float(value):
            return int(value)
        if kind is float and not isinstance(value, bool):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    names = {bool: "true or false", str: "text", int: "a whole number", float: "a number"}
    raise InputError(f"{key}: {value!r} is not {names[kind]}")


def _typed_section(kind: Any, value: Any, key: str) -> Any:
    prefix = f"{key}." if key else ""
    require(
        isinstance(value, dict),
        f"{key}: {value!r} is one value where keys are expected; use {prefix}<key>=...",
    )
    hints = get_type_hints(kind)
    known = {f.name for f in dataclasses.fields(kind)}
    for name in value:
        if name not in known:
            raise InputError(_unknown_key(f"{prefix}{name}", _keys(kind, prefix)))
    missing = [
        f.name for f in dataclasses.fields(kind) if f.name not in value and _has_no_default(f)
    ]
    require(
        not missing, f"{prefix}{missing[0] if missing else ''}: this key has no value; give it one"
    )
    return kind(**{name: _typed(hints[name], value[name], f"{prefix}{name}") for name in value})


def _has_no_default(item: dataclasses.Field[Any]) -> bool:
    return item.default is dataclasses.MISSING and item.default_factory is dataclasses.MISSING


def _keys(kind: Any, prefix: str = "") -> list[str]:
    """All keys of a configuration type, dotted, sections included."""
    found = []
    for name, hint in get_type_hints(kind).items():
        found.append(f"{prefix}{name}")
        if get_origin(hint) is UnionType:  # X | None
            hint = get_args(hint)[0]
        if dataclasses.is_dataclass(hint):
            found += _keys(hint, f"{prefix}{name}.")
    return found


def _unknown_key(key: str, known: Sequence[str]) -> str:
    if key in RENAMED:
        return f"{key}: this key was renamed; use {RENAMED[key]}"
    leaf = key.rsplit(".", 1)[-1]
    by_leaf = {name.rsplit(".", 1)[-1]: name for name in known}
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.6) or [
        by_leaf[name] for name in difflib.get_close_matches(leaf, by_leaf, n=1, cutoff=0.7)
    ]
    inside = [name for name in known if near and name.startswith(f"{near[0]}.")]
    if inside and key.startswith(f"{near[0]}."):  # the section is right, the key in it is not
        return f"{key}: there is no such key; there are {', '.join(inside)}"
    hint = f"did you mean {near[0]}?" if near else "`python -m owtsweep sweep --cfg` shows all keys"
    return f"{key}: there is no such key; {hint}"


def one_line(error: Exception, study: str = "hub") -> str:
    """Hydra's and OmegaConf's messages span lines; keep what names the argument and the fault."""
    text = str(error)
    full_key = getattr(error, "full_key", None)
    cause = error.__cause__
    unknown = re.search(r"Could not override '([^']+)'", text)
    if unknown and "is not in struct" in f"{text} {cause}":
        from owtsweep.studies import get_study

        return _unknown_key(unknown.group(1), _keys(get_study(study).config_type()))
    if text.startswith("Ambiguous value"):
        key = re.search(r"argument '([^=']+)=", text)
        name = key.group(1) if key else "override"
        return f"{name}: several values need --multirun, or [...] where the key takes a list"
    group = re.search(r"In '[^']*': Could not find '([\w-]+)/([^']*)'", text)
    if group is None:
        group = re.search(r"Could not (?:find|load) '?([\w-]+)/([^'.\s]+)", text)
    if group:
        options = group_options(group.group(1))
        if options:
            return f"{group.group(1)}: there is no {group.group(2)!r}; use {' or '.join(options)}"
    plugin = re.search(r"Could not find '(hydra/\w+)/([^']*)'", text)
    if plugin:
        return f"{plugin.group(1)}: there is no {plugin.group(2)!r}; is its plugin installed?"
    override = getattr(error, "override", None)
    if override or text.startswith("Error parsing override"):
        shown = override or text.split("'")[1]
        return f"{shown}: this is no override; use key=value, with quotes around special characters"
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    message = lines[0] if lines else type(error).__name__
    if full_key:
        value = re.sub(r"\s+", " ", message)
        return f"{full_key}: {value}"
    return re.sub(r"\s+", " ", message)


def group_options(group: str) -> list[str]:
    """The names of a Hydra group's files."""
    return sorted(path.stem for path in (conf_directory() / group).glob("*.yaml"))


def dump(config: Config) -> str:
    """The resolved configuration as YAML, every key of it, as stored in a run's config.yaml."""
    from omegaconf import OmegaConf

    from owtsweep.longlists import Marks, in_yaml, marked

    marks = Marks()
    plain = marked(_plain(dataclasses.asdict(config)), marks)
    return in_yaml(OmegaConf.to_yaml(OmegaConf.create(plain)), marks)


def load(path: Path) -> Config:
    """Read a run's config.yaml.

    Raises
    ------
    InputError
        If it is missing or is no configuration of this program.
    """
    from omegaconf import OmegaConf

    try:
        loaded = OmegaConf.load(path)
    except Exception as error:  # the YAML library's own errors have no common, typed base
        text = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a configuration ({text})") from error
    try:
        return from_mapping(loaded)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value
