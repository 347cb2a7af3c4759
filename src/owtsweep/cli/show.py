"""`show`: print how a run was made and what its folder holds."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.cli.program import DONE
from owtsweep.config import require
from owtsweep.errors import InputError

if TYPE_CHECKING:
    from owtsweep.sweep.runs import Run


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print a run's manifest, and what its folder holds now."""
    from owtsweep.api import load

    opened = load(options.run)
    path = opened.folder / "manifest.json"
    require(path.is_file(), f"{opened.folder}: there is no manifest.json in it; run its sweep")
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        manifest = None
    require(isinstance(manifest, dict), f"{path}: this is no manifest; run its sweep again")
    _print({**_shorten(manifest, opened), "now": _describe_folder(opened)}, 0)
    return DONE


def _shorten(manifest: dict[str, Any], opened: Run) -> dict[str, Any]:
    """The manifest without its long lists."""
    shown = dict(manifest)
    if shown.get("state") == "running":
        shown["state"] = "running, or killed: its end is not written"
    if "config" in shown:
        shown["config"] = f"see {opened.folder / 'config.yaml'}"
    if isinstance(shown.get("blocks"), dict):
        shown["blocks"] = {k: v for k, v in shown["blocks"].items() if k != "each"}
    return shown


def _describe_folder(opened: Run) -> dict[str, Any]:
    """The contents of the run folder; reads all shards."""
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
    except InputError as error:  # a run of before plans were stored, with a scheme of its author's
        return {"cases": str(error)}
    for key, block in plan.items():
        cases[opened.store.status(key)] += block.cases
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
    width = max((len(key) for key in section), default=0)
    for key, value in section.items():
        if isinstance(value, Mapping):
            print(f"{'  ' * depth}{key}:")
            _print(value, depth + 1)
        else:
            text = " ".join(map(str, value)) if isinstance(value, list) else value
            print(f"{'  ' * depth}{key:<{width}}  {text}")
