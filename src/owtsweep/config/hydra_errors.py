"""Turn errors of Hydra and OmegaConf, whose messages have several lines, into one line each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from owtsweep.config.hints import explain_key_of_list, explain_unknown_key, list_keys
from owtsweep.config.tree import Tree
from owtsweep.errors import InputError


@contextmanager
def hydra_in_one_line(tree: Tree | None = None) -> Iterator[None]:
    """Turn errors of Hydra, OmegaConf and YAML inside the context into an `InputError`.

    `tree` is the folder of YAML files that Hydra composes. If it is given, the message about a
    wrong key or option also names valid ones.

    Raises
    ------
    InputError
        Instead of those errors; the message is one line.
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

    `tree` is the folder of YAML files that Hydra composes. If it is given, the message about a
    wrong key or option also names valid ones.
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
