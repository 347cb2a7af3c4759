"""Suggest what the user may have meant by a wrong configuration key or a wrong name."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any, get_origin

from owtsweep.config.section import bare_type, fields_along, is_section, read_facts

#: Of keys in several sections that have one name, at most this many are suggested.
MOST_NAMED = 3


def list_keys(model: Any, prefix: str = "") -> list[str]:
    """Return all dotted keys of a configuration, e.g. "compute" and "compute.workers".

    `model` is the pydantic class of the configuration or of a section of the configuration.
    `prefix` is put before every key.
    """
    keys = []
    for name, field in model.model_fields.items():
        keys.append(f"{prefix}{name}")
        if is_section(kind := bare_type(field.annotation)):
            keys += list_keys(kind, f"{prefix}{name}.")
    return keys


def explain_unknown_key(key: str, keys: Sequence[str]) -> str:
    """Return a one-line message about a configuration key that does not exist.

    The message lists the keys in the same section, or names the most similar key, or says how to
    print all keys.

    Parameters
    ----------
    key
        The wrong key, e.g. "compute.worker".
    keys
        All keys that exist.
    """
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


def explain_key_of_list(words: Sequence[str], model: Any) -> str:
    """Return a one-line message about the first override whose key leads into a list; "" if none.

    `words` are overrides, and `model` is the pydantic class of the configuration.
    """
    for word in words:
        path = word.lstrip("+~").partition("=")[0].split(".")
        fields = fields_along(model, path)
        if 0 < len(fields) < len(path) and get_origin(bare_type(fields[-1].annotation)) is list:
            key = ".".join(path[: len(fields)])
            unit = read_facts(fields[-1])["unit"]
            told = f" in {unit}" if unit else ""
            return f"{'.'.join(path)}: there is no such key; {key} is a list{told}: use {key}=[...]"
    return ""


def suggest_name(name: str, names: Sequence[str]) -> str:
    """Return words for an error message about a wrong name; the words list all valid `names`.

    If one of `names` is similar to `name`, the words begin with "did you mean" and the most similar
    name.
    """
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return (f"did you mean {near[0]}? There" if near else "there") + f" are {', '.join(names)}"
