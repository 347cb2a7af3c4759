"""Prints the keys of a study with their units, defaults and meanings: `sweep --help study=NAME`."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from owtsweep.config import as_mapping
from owtsweep.config.reference import SECTION, KeyFacts, describe_keys
from owtsweep.studies.registry import compose, find_entry

#: Columns of the lines: the same text on a terminal and in a pipe.
WIDTH = 100
#: Columns before a key's meaning.
INDENT = 6


def print_keys(study: str) -> None:
    """Print each key of a study.

    Raises InputError if there is no study of this name.
    """
    config = compose([f"study={study}"], primary=find_entry(study).primary)
    first = next(iter(config.by_tuning().values()))  # of several tunings, for its sections
    defaults = {**as_mapping(first), **as_mapping(config)}
    print(f"The keys of study={study}: default, unit, meaning. Set one by key=value.")
    for facts in describe_keys(type(config), defaults):
        print("\n".join(_describe(facts)))
    print("docs/configuration.md has the keys of all studies; `owtsweep list` the config groups.")


def _describe(facts: KeyFacts) -> Iterator[str]:
    if facts.type == SECTION:
        yield f"{facts.key}: {facts.meaning}"
        return
    default = "(see --cfg)" if facts.default is None else facts.default
    unit = f" {facts.unit}" if facts.unit else ""
    yield f"  {facts.key}={default}{unit}"
    bounds = f" ({', '.join(facts.bounds)})" if facts.bounds else ""
    text = f"{facts.meaning}{bounds}"
    space = " " * INDENT
    yield from textwrap.wrap(text, WIDTH, initial_indent=space, subsequent_indent=space)
