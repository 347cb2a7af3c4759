"""Say in one line what is wrong with a key or a name, and what the user may have meant.

Errors of Hydra and OmegaConf, whose messages have several lines, become one line each.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import get_origin

from owtsweep.config.common import Tree
from owtsweep.config.section import Section, bare_type, fields_along, is_section, read_facts
from owtsweep.errors import InputError

#: Of keys in several sections that have one name, at most this many are suggested.
MOST_NAMED = 3


def list_keys(model: type[Section], prefix: str = "") -> list[str]:
    """Return all dotted keys of a model, e.g. "compute" and "compute.workers", after `prefix`."""
    keys = []
    for name, field in model.model_fields.items():
        keys.append(f"{prefix}{name}")
        if is_section(kind := bare_type(field.annotation)):
            keys += list_keys(kind, f"{prefix}{name}.")
    return keys


def explain_unknown_key(key: str, keys: Sequence[str]) -> str:
    """Return a one-line message about a configuration key that does not exist.

    It lists the keys in the same section, or names the most similar key, or says how to print all
    keys. Of a key that exists but that no YAML file sets, it says how to set it.
    """
    if key in keys:
        return f"{key}: no YAML file sets this key yet; use +{key}=..."
    section, _, leaf = key.rpartition(".")
    by_leaf: dict[str, list[str]] = {}
    for name in keys:
        by_leaf.setdefault(name.rsplit(".", 1)[-1], []).append(name)
    alike = [by_leaf[name] for name in difflib.get_close_matches(leaf, by_leaf, n=1, cutoff=0.7)]
    named = alike[0] if alike else []
    highest = [n for n in named if n.count(".") == min(other.count(".") for other in named)]
    if not section and 0 < len(highest) <= MOST_NAMED:
        near = highest  # the section was left out: name every one that has this key
    else:
        near = difflib.get_close_matches(key, keys, n=1, cutoff=0.6) or [a[-1] for a in alike]
    beside = _list_beside(section, keys)
    if beside and (not near or near[0] == section):  # the section is right, the key in it is not
        return f"{key}: there is no such key; there are {', '.join(beside)}"
    above = _list_beside(section.rpartition(".")[0], keys)
    if above and section not in keys and not difflib.get_close_matches(key, near, cutoff=0.8):
        section = section.rpartition(".")[0]  # the section above is right, and the one in it is not
        return f"{key}: there is no such key; below {section} there are {', '.join(above)}"
    hint = f"did you mean {' or '.join(near)}?" if near else "`owtsweep sweep --cfg` shows all keys"
    return f"{key}: there is no such key; {hint}"


def _list_beside(section: str, keys: Sequence[str]) -> list[str]:
    """Return the keys right below a section; none of the top."""
    return [name for name in keys if section and name.rpartition(".")[0] == section]


def explain_key_of_list(words: Sequence[str], model: type[Section]) -> str:
    """Return a one-line message about the first override with a key inside a list; "" if none."""
    for word in words:
        path = word.lstrip("+~").partition("=")[0].split(".")
        fields = fields_along(model, path)
        if 0 < len(fields) < len(path) and get_origin(bare_type(fields[-1].annotation)) is list:
            key = ".".join(path[: len(fields)])
            unit = read_facts(fields[-1])["unit"]
            where = f" in {unit}" if unit else ""
            return (
                f"{'.'.join(path)}: there is no such key; {key} is a list{where}: use {key}=[...]"
            )
    return ""


def suggest_name(name: str, names: Sequence[str]) -> str:
    """Return words for an error message about a wrong name: the most similar, and all `names`."""
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return (f"did you mean {near[0]}? There" if near else "there") + f" are {', '.join(names)}"


@contextmanager
def hydra_in_one_line(tree: Tree | None = None) -> Iterator[None]:
    """Turn errors of Hydra, OmegaConf and YAML inside the context into an `InputError` of one line.

    With `tree`, the message about a wrong key or option also names valid ones.
    """
    from hydra.errors import HydraException
    from omegaconf.errors import OmegaConfBaseException
    from yaml import YAMLError

    try:
        yield
    except YAMLError as error:  # it names the file
        raise InputError(f"config: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise InputError("config: its lists and mappings lie too deep in each other") from error
    except (HydraException, OmegaConfBaseException) as error:
        raise InputError(in_one_line(error, tree)) from error


def in_one_line(error: Exception, tree: Tree | None = None) -> str:
    """Return the message of an error of Hydra or OmegaConf in one line.

    With `tree`, the message about a wrong key or option also names valid ones.
    """
    text = str(error)
    unknown = re.search(r"Could not override '([^']+)'", text)
    if tree and unknown and "is not in struct" in f"{text} {error.__cause__}":
        return explain_unknown_key(unknown[1], list_keys(tree.model))
    if text.startswith("Ambiguous value"):
        key = re.search(r"argument '([^=']+)=", text)
        name = key[1] if key else "override"
        return f"{name}: several values need --multirun, or [...] where the key takes a list"
    group = re.search(r"In '[^']*': Could not find '([\w-]+)/([^']*)'", text)
    if group is None:
        group = re.search(r"Could not (?:find|load) '?([\w-]+)/([^'.\s]+)", text)
    if tree and group and (options := tree.options(group[1])):
        return f"{group[1]}: there is no {group[2]!r}; use {' or '.join(options)}"
    plugin = re.search(r"Could not find '(hydra/\w+)/([^']*)'", text)
    if plugin:
        extra = " pip install 'owtsweep[launchers]' brings joblib, submitit_local, submitit_slurm"
        advice = extra if plugin[1] == "hydra/launcher" else ""
        return f"{plugin[1]}: there is no {plugin[2]!r}; is its plugin installed?{advice}"
    if text.startswith("Error merging override"):  # a list instead of a mapping, or the reverse
        word = text.removeprefix("Error merging override ")
        if tree and (into_list := explain_key_of_list([word], tree.model)):
            return into_list
        place, _, value = word.partition("=")
        if getattr(error.__cause__, "object_type", None) is list:
            return f"{place}: {value} is no list; use e.g. {place}=[{value}]"
        return f"{place}: {value} is a list where keys are expected; use {place}.<key>=..."
    override = getattr(error, "override", None)
    if override or text.startswith("Error parsing override"):
        shown = override or text.split("'")[1]
        return f"{shown}: this is no override; use key=value, with quotes around special characters"
    lines = [" ".join(line.split()) for line in text.splitlines() if line.strip()]
    message = lines[0] if lines else type(error).__name__
    full_key = getattr(error, "full_key", None)
    return f"{full_key}: {message}" if full_key else message
