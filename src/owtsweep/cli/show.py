"""The command `show`: print how a run was made and what the run's folder holds."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence

from owtsweep.cli.program import DONE
from owtsweep.config import Plain
from owtsweep.config.grid import CONTEST_KEYS
from owtsweep.errors import InputError, printable
from owtsweep.sweep.asked import Question
from owtsweep.sweep.runs import Run

#: In a manifest, sections nested deeper than `DEEPEST` are not shown, and names longer than
#: `WIDEST` characters are not aligned.
DEEPEST, WIDEST = 20, 60
#: Most questions that are listed, and most characters of a question's line.
MOST_QUESTIONS, LONGEST_LINE = 50, 400


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print how the run `options.run` was made and what the run's folder holds, and return 0.

    How the run was made is read from the manifest in the run's folder. `options` are the parsed
    arguments of the command; `argv` is not used.

    Raises InputError if the folder holds no run, or the manifest cannot be read.
    """
    from owtsweep.api import load
    from owtsweep.sweep.manifest import read_manifest

    opened = load(options.run)
    manifest = read_manifest(opened.folder)
    shown = {**_shorten(manifest, opened), "now": _describe_folder(opened)}
    origin, questions = opened.study.describe_origin(opened.config), _describe_questions(opened)
    parts = {"origin": origin, **shown, "asked": questions}
    _print({name: part for name, part in parts.items() if part not in ("", {})}, 0)
    return DONE


def _shorten(manifest: Plain, opened: Run) -> Plain:
    """Return a run's manifest without the list of blocks, and with less on the configuration.

    In place of the configuration stands the path of config.yaml. `opened` is the run.
    """
    shown = dict(manifest)
    if shown.get("state") == "running":
        shown["state"] = "running, or killed: its end is not written"
    if "config" in shown:
        shown["config"] = f"see {opened.folder / 'config.yaml'}"
    if isinstance(shown.get("blocks"), dict):
        shown["blocks"] = {k: v for k, v in shown["blocks"].items() if k != "each"}
    return shown


def _describe_folder(opened: Run) -> dict[str, object]:
    """Return how many cases, tables and figures a run's folder holds, as entries to print.

    All stored cases of the run are read, which may take some time.
    """
    figures = opened.place / "figures"
    drawn = len(list(figures.glob("*.png"))) if figures.is_dir() else 0
    return {
        **_count_cases(opened),
        "tables": [path.name for path in sorted(opened.place.glob("*.csv"))] or "none yet",
        "figures": f"{drawn} in {figures}" if drawn else "none yet",
    }


def _describe_questions(opened: Run) -> dict[str, str]:
    """Return a line on each question of the run folder, by the name of the question's folder.

    Of more than `MOST_QUESTIONS`, the last line counts the others.
    """
    from owtsweep.sweep.asked import is_shown, list_questions

    home = opened.home or opened.folder
    found = list(list_questions(home))
    lines = {
        one.hash: f"{'* ' if is_shown(home, one.hash) else ''}{_describe_question(opened, one)}"
        for one in found[:MOST_QUESTIONS]
    }
    left = len(found) - len(lines)
    notes = {"*": "shown by the root of the run folder"} if lines else {}
    return lines | ({"...": f"{left} more"} if left else {}) | notes


def _describe_question(opened: Run, question: Question) -> str:
    """Return when a question was asked last, its tunings, the sizes of its grid, and its schemes.

    Whatever the stored configuration holds there is taken as text.
    """
    from owtsweep.sweep.asked import question_folder
    from owtsweep.sweep.manifest import read_manifest

    if question.trouble:
        return question.trouble
    home = opened.home or opened.folder
    try:
        when = str(read_manifest(question_folder(home, question.hash)).get("started"))
    except InputError:
        when = "time unknown"
    schemes = question.config.get("schemes")
    parts = [when]
    if question.config.get("tuning"):
        parts.append(f"tuning {_as_line(question.config['tuning'], 0)}")
    parts += [f"{name} {_count(value)}" for name, value in _list_grid(opened, question)]
    if isinstance(schemes, list):
        parts.append("schemes " + " ".join(map(_name_scheme, schemes)))
    return ", ".join(parts)[:LONGEST_LINE]


def _list_grid(opened: Run, question: Question) -> Iterator[tuple[str, object]]:
    """Yield name and values of each axis of a question's grid, then the grid's further numbers.

    An axis that the run's conditions do not have is left out: with motion=plant the hub study has
    sea states in place of natural periods and amplitudes.
    """
    conditions = {condition.name for condition in opened.study.conditions(opened.config)}
    for key in opened.config.swept:
        section, _, name = key.rpartition(".")
        values = question.config.get(section)
        if name in conditions and isinstance(values, Mapping) and values.get(name) is not None:
            yield name, values[name]
    grid = question.config.get("grid")
    for name, values in grid.items() if isinstance(grid, Mapping) else ():
        if name in CONTEST_KEYS:
            continue
        if name in conditions or not isinstance(values, list | None):
            yield name, values


def _count(value: object) -> str:
    return f"({len(value)})" if isinstance(value, list) else str(value)


def _name_scheme(entry: object) -> str:
    """Return the name of an entry of the key `schemes`; a user's class is not imported."""
    if isinstance(entry, Mapping):
        return str(entry.get("name", str(entry.get("_target_")).rpartition(".")[-1]))
    return str(entry)


def _count_cases(opened: Run) -> dict[str, object]:
    cases = dict.fromkeys(("done", "failed", "missing"), 0)
    store = opened.store
    for key, block in opened.plan().items():
        cases[store.status(key)] += block.cases
    unable: dict[str, int] = {}
    for setback in opened.unable():
        unable[setback.reason] = unable.get(setback.reason, 0) + setback.cases
    return {
        "cases in finished blocks": cases["done"],
        "cases in blocks with failures": cases["failed"],
        "cases missing": cases["missing"],
        **({"cases without a number": unable} if unable else {}),
    }


def _print(section: Mapping[str, object], depth: int) -> None:
    width = min(max((len(key) for key in section), default=0), WIDEST)
    for key, value in section.items():
        name = printable(key)
        if isinstance(value, Mapping) and depth < DEEPEST:
            print(f"{'  ' * depth}{name}:")
            _print(value, depth + 1)
        else:
            print(f"{'  ' * depth}{name:<{width}}  {printable(_as_line(value, depth))}")


def _as_line(value: object, depth: int) -> str:
    if isinstance(value, list) and depth < DEEPEST:
        return " ".join(_as_line(item, depth + 1) for item in value)
    return "..." if isinstance(value, list | Mapping) and depth >= DEEPEST else str(value)
