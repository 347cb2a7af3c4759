"""Suggestions for a wrong key or name."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any

from owtsweep.config.section import bare_type, is_section

#: Old key -> new key. The error for a renamed key gives its new name.
RENAMED: dict[str, str] = {}


def list_keys(model: Any, prefix: str = "") -> list[str]:
    """Return all dotted keys of a configuration's model; sections are keys too.

    `prefix` is put before every key.
    """
    keys = []
    for name, field in model.model_fields.items():
        keys.append(f"{prefix}{name}")
        if is_section(kind := bare_type(field.annotation)):
            keys += list_keys(kind, f"{prefix}{name}.")
    return keys


def explain_unknown_key(key: str, keys: Sequence[str]) -> str:
    """Return a one-line message about a key that is not in `keys`.

    The message gives the new name of a renamed key, or the other keys of the key's section, or the
    most similar key.
    """
    if key in RENAMED:
        return f"{key}: this key was renamed; use {RENAMED[key]}"
    section, _, leaf = key.rpartition(".")
    by_leaf = {name.rsplit(".", 1)[-1]: name for name in keys}
    near = difflib.get_close_matches(key, keys, n=1, cutoff=0.6) or [
        by_leaf[name] for name in difflib.get_close_matches(leaf, by_leaf, n=1, cutoff=0.7)
    ]
    beside = [name for name in keys if section and name.startswith(f"{section}.")]
    if beside and (not near or near[0] == section):  # the section is right, the key in it is not
        return f"{key}: there is no such key; there are {', '.join(beside)}"
    hint = f"did you mean {near[0]}?" if near else "`owtsweep sweep --cfg` shows all keys"
    return f"{key}: there is no such key; {hint}"


def suggest_name(name: str, names: Sequence[str]) -> str:
    """Return words that list all names, after the most similar one if any is similar."""
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return (f"did you mean {near[0]}? There" if near else "there") + f" are {', '.join(names)}"
