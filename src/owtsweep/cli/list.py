"""The command `list`: print the available studies, schemes and config groups."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from owtsweep.cli import DONE
from owtsweep.config import Tree
from owtsweep.errors import InputError
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

    A study of another package that cannot be loaded is listed with its error. The arguments
    `options` and `argv` are not used.
    """
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


def _list_choices(study: str, tree: Tree) -> list[str]:
    prefix = "" if study == DEFAULT else f"study={study} "
    with blame_package(study):
        lines = _list_schemes(study, prefix)
        for group in tree.groups():
            lines.append(f"{prefix}{PLURALS.get(group, group + 's')} ({group}=...):")
            for option in tree.options(group):
                lines.append(_entry(option, _first_comment(tree, group, option)))
    return lines


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
