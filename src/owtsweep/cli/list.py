"""The command `list`: print the available studies, schemes and config groups, or one of them."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from itertools import chain
from pathlib import Path

from owtsweep.cli import DONE
from owtsweep.config import Tree, require
from owtsweep.errors import InputError, shorten
from owtsweep.studies import get_study, names
from owtsweep.studies.registry import (
    DEFAULT,
    blame_package,
    find_tree,
    list_schemes,
    list_simplicity,
)

#: What the number before a scheme's sentence is.
MEANING = "states + tuned numbers, 1000 more if late, 2000 if after the record"
#: Plurals of group names that are not formed by adding an s.
PLURALS = {"spectrum": "spectra", "sensors": "sensors", "compute": "compute"}


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print all studies, then the schemes and config groups of each study, and return 0.

    With a name in `options.names`, print what this study, group or scheme is; with `study=STUDY`
    too, in this study alone. A study of another package that cannot be loaded is listed with its
    error. `argv` is not used.

    Raises InputError if nothing has this name, or several are given.
    """
    if options.names:
        print("\n".join(_find(*_split(options.names))))
        return DONE
    print("studies (study=...):")
    choices: dict[Path, list[str]] = {}
    for name in names():
        try:
            purpose = _purpose(name)
            tree = find_tree(name)
            if tree.folder not in choices:
                choices[tree.folder] = _list_choices(name, tree)
        except InputError as error:  # a broken study of another package; list the others
            purpose = str(error)
        print(_entry(name, purpose))
    for line in chain(*choices.values()):
        print(line)
    return DONE


def _split(words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the name that is asked for, and the studies in which it is looked for."""
    chosen = [word.removeprefix("study=") for word in words if word.startswith("study=")]
    asked = [word for word in words if not word.startswith("study=")] or chosen
    require(
        len(asked) == 1 and len(chosen) <= 1,
        f"NAME: {shorten(' '.join(words))}: give one name, e.g. HME1 or HOLD study=blade",
    )
    for study in chosen:
        get_study(study)
    return asked[0], chosen or [*names()]


def _find(name: str, studies: Sequence[str]) -> list[str]:
    """Return lines on a study, a config group or a scheme, in each of some studies that has it.

    Raises InputError if nothing has this name; the message names what is most alike.
    """
    if name in names():
        return [_entry(name, _purpose(name)), *_list_choices(name, find_tree(name))]
    lines: list[str] = []
    known: set[str] = {*names()}
    seen: set[Path] = set()
    for study in studies:
        try:
            schemes, tree = list_schemes(study), find_tree(study)
        except InputError:  # a broken study of another package
            continue
        shared, groups = tree.folder in seen, tree.groups()
        seen.add(tree.folder)
        known |= {*schemes, *groups}
        if name in groups and not shared:
            lines += _list_group(_prefix(study), tree, name)
        if name in schemes:
            lines += _list_facts(study, name, schemes[name])
    if not lines:
        near = get_close_matches(name, sorted(known), n=2, cutoff=0.6)
        hint = f"did you mean {' or '.join(near)}?" if near else "`owtsweep list` has all names"
        raise InputError(f"{shorten(name)}: no study, config group or scheme; {hint}")
    return lines


def _list_facts(study: str, name: str, sentence: str) -> list[str]:
    with blame_package(study):
        facts = get_study(study).describe_scheme(name)
    told = (f"  {fact:<10} {text}" for fact, text in facts.items())
    return [f"{_prefix(study)}schemes=[{name}]: {sentence}", *told]


def _prefix(study: str) -> str:
    return "" if study == DEFAULT else f"study={study} "


def _list_choices(study: str, tree: Tree) -> list[str]:
    prefix = _prefix(study)
    with blame_package(study):
        groups = (_list_group(prefix, tree, group) for group in tree.groups())
        return [*_list_schemes(study, prefix), *chain(*groups)]


def _list_group(prefix: str, tree: Tree, group: str) -> list[str]:
    return [f"{prefix}{PLURALS.get(group, group + 's')} ({group}=...):"] + [
        _entry(option, _first_comment(tree, group, option)) for option in tree.options(group)
    ]


def _list_schemes(study: str, prefix: str) -> list[str]:
    """Return a heading, and a line for each scheme with its simplicity, the simplest first.

    A scheme of another package, which is not imported, has no number and stands last.
    """
    schemes, simplicity = list_schemes(study), list_simplicity(study)
    if not schemes:
        return []
    explained = f"; {MEANING}" if study == DEFAULT else ""
    names = sorted(schemes, key=lambda name: simplicity.get(name, math.inf))
    width = max(map(len, names))
    numbers = {name: f"{simplicity.get(name, '-'):>4} " if simplicity else "" for name in names}
    return [f"{prefix}schemes (schemes=[...]{explained}):"] + [
        f"  {name:<{width}} {numbers[name]}{schemes[name]}" for name in names
    ]


def _entry(name: str, purpose: str) -> str:
    return f"  {name:<16} {purpose}"


def _purpose(study: str) -> str:
    """Return the first line of the docstring of the module that defines a study.

    `study` is the study's name. Without a docstring, return "".
    """
    lines = (sys.modules[type(get_study(study)).__module__].__doc__ or "").splitlines()
    return lines[0] if lines else ""


def _first_comment(tree: Tree, group: str, option: str) -> str:
    path = tree.folder / group / f"{option}.yaml"
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# ") and not line.startswith("# @"):
            return line[2:]
    return ""
