"""`list`: what there is to choose from."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli import DONE
from owtsweep.config import conf_directory, group_options

GROUPS = {
    "tuning": "tunings",
    "spectrum": "spectra",
    "sensors": "sensors",
    "grid": "grids",
    "experiment": "experiments",
    "compute": "compute",
}


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print schemes and config groups with the first line of what they say of themselves."""
    from owtsweep.studies.hub.schemes import REGISTERED

    print("schemes (schemes=[...]):")
    for name, (_, purpose) in REGISTERED.items():
        print(f"  {name:<12}{purpose}")
    for group, plural in GROUPS.items():
        print(f"{plural} ({group}=...):")
        for option in group_options(group):
            print(f"  {option:<12}{_first_comment(group, option)}")
    return DONE


def _first_comment(group: str, option: str) -> str:
    path = conf_directory() / group / f"{option}.yaml"
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# ") and not line.startswith("# @"):
            return line[2:]
    return ""
