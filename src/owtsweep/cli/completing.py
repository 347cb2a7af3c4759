"""Completes overrides of the command line in the shell, which the package argcomplete asks for."""

from __future__ import annotations

import argparse

from owtsweep.errors import InputError


def complete_override(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return the studies, then options of groups and keys of the study that is named, or the hub.

    argcomplete offers those of them that begin as the word that is typed.
    """
    from owtsweep.config.hints import list_keys
    from owtsweep.studies import names
    from owtsweep.studies.registry import DEFAULT, find_tree

    given = parsed_args.overrides
    named = [word.removeprefix("study=") for word in given if word.startswith("study=")]
    try:
        tree = find_tree(named[-1] if named else DEFAULT)
    except InputError:  # an override before this one is wrong; the command will say so
        return []
    keys = list_keys(tree.model)
    sections = {key.rpartition(".")[0] for key in keys}
    return [
        *(f"study={name}" for name in names()),
        *(f"{group}={option}" for group in tree.groups() for option in tree.options(group)),
        *(f"{key}=" for key in keys if key not in sections),
    ]
