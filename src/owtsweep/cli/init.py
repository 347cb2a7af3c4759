"""The command `init`: write the first version of a scheme, a structure or a study of one's own."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from string import Template

from owtsweep.cli.program import DONE, program_here
from owtsweep.errors import require
from owtsweep.io.files import refuse_in_one_line, write_all

TEMPLATES = Path(__file__).with_name("templates")
#: What a module of Python, a file and a study can all be called.
NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
#: The studies that take schemes of a user, with one of their own to run beside.
STUDIES = {"hub": "MKF", "tower": "AKF", "floater": "KF_REPAIRED", "blade": "MEKF"}
#: Kind of what is written -> file to write -> template.
FILES = {
    "scheme": {"$name.py": "scheme_$study"},
    "structure": {"$name.yaml": "structure"},
    "study": {
        "owtsweep-$name/pyproject.toml": "study_pyproject",
        "owtsweep-$name/${name}_study/__init__.py": "study_module",
        "owtsweep-$name/${name}_study/conf/sweep.yaml": "study_sweep",
        "owtsweep-$name/tests/test_$name.py": "study_test",
    },
}
#: Kind -> what to do next; the first line checks what was written.
NEXT = {
    "scheme": (
        "python $name.py",
        'PYTHONPATH=. $program sweep study=$study "schemes=[$ours,{_target_:$name.$title}]"',
    ),
    "structure": (
        "$program place study=tower structure=./$name.yaml",
        "$program sweep motion=plant structure=./$name.yaml",
    ),
    "study": (
        "pip install -e ./owtsweep-$name",
        "python -m pytest ./owtsweep-$name",
        "$program sweep study=$name",
    ),
}


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write the files into the current folder, print them and what to do next, and return 0.

    Raises InputError if the name cannot be used, the study takes no schemes, or a file is there.
    """
    kind, name = options.kind, options.name
    study = _read_study(kind, options.overrides)
    require(
        NAME.fullmatch(name) is not None and not iskeyword(name),
        f"NAME: {name!r} cannot be used; give lower-case letters, digits and _, at most 40, of "
        "which the first is a letter, e.g. my_filter",
    )
    words = {
        "name": name,
        "title": "".join(part.capitalize() for part in name.split("_")),
        "study": study,
        "ours": STUDIES[study],
        "program": program_here(),
    }
    files = {
        Path(_fill(file, words)): _fill(_read(_fill(template, words)), words)
        for file, template in FILES[kind].items()
    }
    for path in {Path(file.parts[0]) for file in files}:
        require(not os.path.lexists(path), f"NAME: {path} is there already; choose another name")
    _check_free(kind, name)
    with refuse_in_one_line(Path()):
        for file in files:
            file.parent.mkdir(parents=True, exist_ok=True)
        write_all(files)
    print(*files, sep="\n")
    print("next:", *(f"  {_fill(line, words)}" for line in NEXT[kind]), sep="\n")
    return DONE


def _check_free(kind: str, name: str) -> None:
    """Raise `InputError` if a module or a study of the name would be hidden, or would hide it."""
    from owtsweep.studies import names

    require(
        kind != "scheme" or find_spec(name) is None,
        f"NAME: {name!r} is a module of Python already; choose another name",
    )
    require(
        kind != "study" or name not in names(),
        f"NAME: {name!r} is a study already; choose another name",
    )


def _read_study(kind: str, overrides: Sequence[str]) -> str:
    """Return the study of a scheme: what `study=...` names, else the hub's."""
    require(
        all(word.startswith("study=") for word in overrides[:1]) and len(overrides) <= 1,
        f"{' '.join(overrides)}: only study=... may follow the name",
    )
    if not overrides:
        return "hub"
    require(kind == "scheme", f"{overrides[0]}: only a scheme belongs to a study; leave it out")
    study = overrides[0].removeprefix("study=")
    require(
        study in STUDIES,
        f"study: {study!r} takes no scheme from a template; use one of {', '.join(STUDIES)}",
    )
    return study


def _read(template: str) -> str:
    return (TEMPLATES / f"{template}.txt").read_text(encoding="utf-8")


def _fill(text: str, words: Mapping[str, str]) -> str:
    return Template(text).substitute(words)
