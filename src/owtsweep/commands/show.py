"""`show`: what a run is and how it came about."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from typing import Any

from owtsweep.cli import DONE
from owtsweep.config import require


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print a run's manifest."""
    from owtsweep.api import load

    opened = load(options.run)
    path = opened.folder / "manifest.json"
    require(path.is_file(), f"{opened.folder}: there is no manifest.json in it; run its sweep")
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        manifest = None
    require(isinstance(manifest, dict), f"{path}: this is no manifest; run its sweep again")
    _print(manifest, 0)
    return DONE


def _print(section: Mapping[str, Any], depth: int) -> None:
    width = max((len(key) for key in section), default=0)
    for key, value in section.items():
        if isinstance(value, Mapping):
            print(f"{'  ' * depth}{key}:")
            _print(value, depth + 1)
        else:
            text = " ".join(map(str, value)) if isinstance(value, list) else value
            print(f"{'  ' * depth}{key:<{width}}  {text}")
