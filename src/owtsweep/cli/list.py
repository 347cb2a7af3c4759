"""`list`: what there is to choose from."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from owtsweep.cli import DONE
from owtsweep.config import Tree
from owtsweep.errors import InputError
from owtsweep.studies import get_study, names
from owtsweep.studies.registry import DEFAULT, tree_of

#: What the options of a group are called, where its own name with an s is no word.
PLURALS = {"spectrum": "spectra", "sensors": "sensors", "compute": "compute"}


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print the studies, then each one's schemes and config groups."""
    print("studies (study=...):")
    shown: list[Tree] = []
    for name in names():
        try:
            print(f"  {name:<12}{_purpose(name)}")
        except InputError as error:  # another package's; the other studies work
            print(f"  {name:<12}{error}")
    for name in names():
        try:
            tree = tree_of(name)
        except InputError:
            continue
        if tree.folder not in [other.folder for other in shown]:
            shown.append(tree)
            _print_choices(name, tree)
    return DONE


def _print_choices(study: str, tree: Tree) -> None:
    prefix = "" if study == DEFAULT else f"study={study} "
    schemes: dict[str, str] = getattr(get_study(study), "schemes", dict)()
    if schemes:
        print(f"{prefix}schemes (schemes=[...]):")
        for name, purpose in schemes.items():
            print(f"  {name:<12}{purpose}")
    for group in tree.groups():
        print(f"{prefix}{PLURALS.get(group, group + 's')} ({group}=...):")
        for option in tree.options(group):
            print(f"  {option:<12}{_first_comment(tree, group, option)}")


def _purpose(study: str) -> str:
    """The first line of what a study's module says of itself."""
    lines = (sys.modules[type(get_study(study)).__module__].__doc__ or "").splitlines()
    return lines[0] if lines else ""


def _first_comment(tree: Tree, group: str, option: str) -> str:
    path = tree.folder / group / f"{option}.yaml"
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# ") and not line.startswith("# @"):
            return line[2:]
    return ""
