"""The command `show`: print how a run was made and what the run's folder holds."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.cli.program import DONE
from owtsweep.errors import InputError, printable

if TYPE_CHECKING:
    from owtsweep.sweep.runs import Run

#: In a manifest, sections nested deeper than `DEEPEST` are not shown, and names longer than
#: `WIDEST` characters are not aligned.
DEEPEST, WIDEST = 20, 60


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print how the run `options.run` was made and what the run's folder holds, and return 0.

    How the run was made is read from the manifest in the run's folder. `options` are the parsed
    arguments of the command; `argv` is not used.

    Raises
    ------
    InputError
        If the folder holds no run, or the manifest cannot be read.
    """
    from owtsweep.api import load
    from owtsweep.sweep.provenance import read_manifest

    opened = load(options.run)
    manifest = read_manifest(opened.folder)
    _print({**_shorten(manifest, opened), "now": _describe_folder(opened)}, 0)
    return DONE


def _shorten(manifest: dict[str, Any], opened: Run) -> dict[str, Any]:
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


def _describe_folder(opened: Run) -> dict[str, Any]:
    """Return how many cases, tables and figures a run's folder holds, as entries to print.

    All stored cases of the run are read, which may take some time.
    """
    figures = opened.folder / "figures"
    drawn = len(list(figures.glob("*.png"))) if figures.is_dir() else 0
    return {
        **_count_cases(opened),
        "tables": [path.name for path in sorted(opened.folder.glob("*.csv"))] or "none yet",
        "figures": f"{drawn} in {figures}" if drawn else "none yet",
    }


def _count_cases(opened: Run) -> dict[str, Any]:
    cases = dict.fromkeys(("done", "failed", "missing"), 0)
    try:
        plan = opened.plan()
    except InputError as error:  # the run has no stored plan, and names a scheme of its author's
        return {"cases": str(error)}
    store = opened.store
    for key, block in plan.items():
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


def _print(section: Mapping[str, Any], depth: int) -> None:
    width = min(max((len(key) for key in section), default=0), WIDEST)
    for key, value in section.items():
        name = printable(key)
        if isinstance(value, Mapping) and depth < DEEPEST:
            print(f"{'  ' * depth}{name}:")
            _print(value, depth + 1)
        else:
            print(f"{'  ' * depth}{name:<{width}}  {printable(_as_line(value, depth))}")


def _as_line(value: Any, depth: int) -> str:
    if isinstance(value, list) and depth < DEEPEST:
        return " ".join(_as_line(item, depth + 1) for item in value)
    return "..." if isinstance(value, list | Mapping) and depth >= DEEPEST else str(value)
