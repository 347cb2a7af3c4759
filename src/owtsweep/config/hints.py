"""Suggest what the user may have meant by a wrong configuration key or a wrong name."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any

from owtsweep.config.section import bare_type, is_section

#: Old key -> new key. The error for a renamed key gives its new name.
RENAMED: dict[str, str] = {}


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

    The message gives the new name if the key was renamed. Otherwise it lists the keys in the same
    section, or names the most similar key, or says how to print all keys.

    Parameters
    ----------
    key
        The wrong key, e.g. "compute.worker".
    keys
        All keys that exist.
    """
    if key in RENAMED:
        return f"{key}: this key was renamed; use {RENAMED[key]}"
    section, _, leaf = key.rpartition(".")
    by_leaf = {name.rsplit(".", 1)[-1]: name for name in keys}
    near = difflib.get_close_matches(key, keys, n=1, cutoff=0.6) or [
        by_leaf[name] for name in difflib.get_close_matches(leaf, by_leaf, n=1, cutoff=0.7)
    ]
    beside = [name for name in keys if section and name.rpartition(".")[0] == section]
    if beside and (not near or near[0] == section):  # the section is right, the key in it is not
        return f"{key}: there is no such key; there are {', '.join(beside)}"
    hint = f"did you mean {near[0]}?" if near else "`owtsweep sweep --cfg` shows all keys"
    return f"{key}: there is no such key; {hint}"


def suggest_name(name: str, names: Sequence[str]) -> str:
    """Return words for an error message about a wrong name; the words list all valid `names`.

    If one of `names` is similar to `name`, the words begin with "did you mean" and the most similar
    name.
    """
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return (f"did you mean {near[0]}? There" if near else "there") + f" are {', '.join(names)}"
