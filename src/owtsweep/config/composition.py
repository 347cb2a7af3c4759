"""Compose a configuration from a folder of YAML files and overrides, with Hydra."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config.common import Tree
from owtsweep.config.hints import explain_key_of_list, hydra_in_one_line
from owtsweep.config.option_files import place_files
from owtsweep.config.section import Plain, fields_along
from owtsweep.config.stored import DEEPEST, read, resolved
from owtsweep.config.tuned import GROUP, holds, join, refuse_tuned_keys
from owtsweep.errors import InputError, require, shorten

if TYPE_CHECKING:
    from omegaconf import DictConfig

#: Most digits of a number in an override: Python makes no number of more than 4300.
MOST_DIGITS = 4000


def get_key(override: str) -> str:
    """Return the key or group that an override sets, without Hydra's `+` and `~`."""
    return override.lstrip("+~").partition("=")[0]


def admit(tree: Tree, overrides: Sequence[str]) -> list[str]:
    """Return the overrides, with `++` before each one whose key is not in the primary file.

    Without `++`, Hydra refuses such a key. Overrides of config groups, and of keys without a
    default in the model, are returned unchanged.
    """
    listed = _listed_keys(tree)
    groups = tree.groups()
    admitted = []
    for override in map(quote_home, overrides):
        path = override.partition("=")[0].split(".")
        fields = fields_along(tree.model, path)
        has_default = any(not field.is_required() for field in fields)  # or its section has one
        unlisted = len(fields) == len(path) and has_default and not holds(listed, path)
        admitted.append(f"++{override}" if unlisted and path[0] not in groups else override)
    return admitted


def quote_home(override: str) -> str:
    """Put quotes around a results folder that begins with `~`: `results=~/x` to `results='~/x'`.

    Hydra accepts `~` only in quotes, and most shells do not replace it after an equals sign.
    """
    return re.sub(r"^(\+*results=)(~[^'\",]*)$", r"\1'\2'", override)


def quoted(text: str) -> str:
    """Return a text in Hydra's quotes, in which every character stands for itself."""
    from hydra.core.override_parser.types import Quote, QuotedString

    return QuotedString(text, Quote.single).with_quotes()


def require_readable(overrides: Sequence[str]) -> None:
    """Check what Hydra would answer with an error of several lines or of another kind.

    Raise `InputError` if an override has no key, or holds a number of more than `MOST_DIGITS`
    digits.
    """
    for override in overrides:
        require(
            override.partition("=")[0].strip("+~") != "",
            f"{override!r}: this is no override; use key=value",
        )
        require(
            re.search(rf"[\d_]{{{MOST_DIGITS + 1}}}", override) is None,
            f"{shorten(override, 60)}: a number has at most {MOST_DIGITS} digits",
        )


def conf_directory() -> Path:
    """Return the folder `conf` of the package's YAML files, installed or in a checkout.

    Raise `InputError` if neither place has a folder `conf` with the file sweep.yaml.
    """
    package = Path(__file__).resolve().parents[1]
    for candidate in (package / "conf", package.parents[1] / "conf"):
        if (candidate / "sweep.yaml").is_file():
            return candidate
    raise InputError(f"conf: no sweep.yaml in {package / 'conf'}: the installation is incomplete")


def compose_hydra(tree: Tree, overrides: Sequence[str], *, settings: bool = False) -> DictConfig:
    """Return what Hydra composes; with `settings`, the object also holds Hydra's own settings.

    Raise `InputError` if Hydra or OmegaConf refuses a file or an override; the message is one line.
    """
    from hydra import compose

    with hydra_in_one_line(tree), _hydra_of(tree):
        return compose(tree.primary, overrides=list(overrides), return_hydra_config=settings)


@contextmanager
def _hydra_of(tree: Tree) -> Iterator[None]:
    """Set Hydra up for a tree, also within a run that Hydra itself has started (a multirun)."""
    from hydra import initialize_config_dir
    from hydra.core.global_hydra import GlobalHydra

    running = GlobalHydra.instance().hydra
    GlobalHydra.instance().clear()
    try:
        with initialize_config_dir(str(tree.folder), version_base="1.3"):
            yield
    finally:
        GlobalHydra.instance().hydra = running


def find_options(tree: Tree, overrides: Sequence[str], group: str) -> list[str]:
    """Return the names of the files of a config group that Hydra would compose, in their order."""
    from hydra.core.global_hydra import GlobalHydra
    from hydra.types import RunMode

    with hydra_in_one_line(tree), _hydra_of(tree):
        loader = GlobalHydra.instance().config_loader()
        chosen = loader.compute_defaults_list(tree.primary, list(overrides), RunMode.RUN).defaults
    paths = [str(default.config_path) for default in chosen]
    return [path.removeprefix(f"{group}/") for path in paths if path.startswith(f"{group}/")]


def compose_plain(tree: Tree, overrides: Sequence[str], config_dir: str | None = None) -> Plain:
    """Compose a tree and overrides, e.g. `["grid.replicates=2"]`, to plain data.

    Of several tunings, e.g. `tuning=[paper,matched]`, each is composed by itself, and the results
    are joined (`owtsweep.config.tuned.join`). A tuning or a section may be a file of the user's
    (`owtsweep.config.option_files`). `config_dir` is a folder with further config groups. Raise
    `InputError` if Hydra refuses an override or a file, `config_dir` is no folder, a value could
    not be stored, or several tunings cannot be joined; the message is one line.
    """
    with place_files(overrides, tree.model) as placed:
        words = [*_search_path(config_dir, placed), *placed]
        return _compose_tunings(tree, words, overrides)


def _compose_tunings(tree: Tree, words: Sequence[str], overrides: Sequence[str]) -> Plain:
    """Compose a tree once for each tuning of `words`; join the results.

    `overrides` are the user's own, for error messages. `words` are those for Hydra: tuning files
    are replaced by options, and the folder that Hydra searches is added.
    """
    plain, chosen = _compose(tree, words)
    if not tree.model.tuned or GROUP in chosen:  # Hydra names no choice if there are several
        return plain
    with _refusing_no_names(tree, words):
        names = list(dict.fromkeys(find_options(tree, words, GROUP)))
    if len(names) < 2:
        return plain
    refuse_tuned_keys(tree.model, overrides, names, _listed_keys(tree))
    others = [word for word in words if word.lstrip("+").partition("=")[0] != GROUP]
    composed = {name: _compose(tree, [*others, f"{GROUP}={name}"])[0] for name in names}
    return join(composed, tree.model.tuned)


def _search_path(config_dir: str | None, overrides: Sequence[str]) -> list[str]:
    """Check the overrides; return the one, if any, that makes Hydra search a further folder."""
    require_readable(overrides)
    for override in overrides:
        require(
            not override.lstrip("+~").startswith("hydra"),
            f"{override}: Hydra's own settings work with --multirun only",
        )
    if config_dir is None:
        return []
    from owtsweep.config.given_files import address_of

    return [f"hydra.searchpath=[{quoted(address_of(_find_folder(config_dir)))}]"]


def _compose(tree: Tree, words: Sequence[str]) -> tuple[Plain, Plain]:
    """Compose a tree; return it as plain data, and group -> the option that was chosen."""
    from omegaconf import open_dict

    with _refusing_no_names(tree, words):
        composed = compose_hydra(tree, words, settings=True)
        chosen = dict(composed.hydra.runtime.choices)
        with open_dict(composed):
            del composed["hydra"]
        plain = resolved(composed)
    for name, value in plain.items():
        _require_storable(name, value)
    return plain, chosen


@contextmanager
def _refusing_no_names(tree: Tree, words: Sequence[str]) -> Iterator[None]:
    """Turn Hydra's errors about a word that is no name of an option into one line."""
    try:
        yield
    except InputError:
        raise
    except (ValueError, TypeError, OSError) as error:  # no name where Hydra expects an option's
        if into_list := explain_key_of_list(words, tree.model):
            raise InputError(into_list) from error
        wrong = [word for word in words if word.split("=")[0] in tree.groups()]
        text = shorten(" ".join(str(error).split()), 300)
        if not wrong:
            raise InputError(f"{' '.join(words)}: this cannot be composed ({text})") from error
        raise InputError(
            f"{shorten(wrong[0], 300)}: this is a config group; name one of its options ({text})"
        ) from error


def _listed_keys(tree: Tree) -> Plain:
    """Return the keys that the tree's primary file sets, as nested mappings."""
    return read(tree.folder / f"{tree.primary}.yaml", resolve=False)


def _find_folder(config_dir: str) -> Path:
    try:
        directory = Path(config_dir).resolve()
        there = config_dir != "" and directory.is_dir()
    except (OSError, ValueError, RuntimeError):  # too long, a null character, a loop of links
        there = False
    require(there, f"--config-dir: {config_dir!r} is no folder")
    return directory


def _require_storable(key: str, value: object, depth: int = 2) -> None:
    """Raise `InputError` if a value, once stored in a run's config.yaml, could not be read again.

    That is a text that contains "${", or a value inside more than `DEEPEST` lists and mappings.
    `depth` is the number of lists and mappings in which the value lies, itself included.
    """
    if isinstance(value, str):
        require("${" not in value, f"{key}: {value!r} holds ${{, which cannot be stored")
    if isinstance(value, dict | list):
        require(depth <= DEEPEST, f"{key}: its lists and mappings lie more than {DEEPEST} deep")
        parts = [*value, *value.values()] if isinstance(value, dict) else value
        for part in parts:
            _require_storable(key, part, depth + 1)
