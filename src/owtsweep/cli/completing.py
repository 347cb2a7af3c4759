"""Completes words of the command line in the shell, by argcomplete, if it is installed."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator

from owtsweep.errors import InputError


def complete(
    parser: argparse.ArgumentParser, subparsers: Iterable[argparse.ArgumentParser]
) -> None:
    """Answer the shell and end the process; return if argcomplete is not installed.

    parser, subparsers: the parser of the whole command line, and those of its commands.
    """
    try:
        import argcomplete
    except ImportError:
        return
    for subparser in subparsers:
        for action in subparser._actions:
            if action.dest == "overrides":
                action.completer = _complete_override  # type: ignore[attr-defined]
    argcomplete.autocomplete(parser)


def _complete_override(prefix: str, parsed_args: argparse.Namespace, **_: object) -> list[str]:
    try:
        return [word for word in _list_overrides(parsed_args.overrides) if word.startswith(prefix)]
    except InputError:  # an override before this one is wrong; the command will say so
        return []


def _list_overrides(given: list[str]) -> Iterator[str]:
    """Yield the studies, then options of groups and keys of the study that is named, or the hub."""
    from owtsweep.config.hints import list_keys
    from owtsweep.studies import names
    from owtsweep.studies.registry import DEFAULT, find_tree

    yield from (f"study={name}" for name in names())
    named = [word.removeprefix("study=") for word in given if word.startswith("study=")]
    tree = find_tree(named[-1] if named else DEFAULT)
    for group in tree.groups():
        yield from (f"{group}={option}" for option in tree.options(group))
    keys = list_keys(tree.model)
    sections = {key.rpartition(".")[0] for key in keys}
    yield from (f"{key}=" for key in keys if key not in sections)
