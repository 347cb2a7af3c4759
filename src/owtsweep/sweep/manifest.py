"""Reads manifest.json of a run folder, which may be another person's, and what it leaves out."""

from __future__ import annotations

import os
from math import isfinite
from pathlib import Path

from owtsweep.config import Config, Plain, require
from owtsweep.errors import InputError
from owtsweep.io.reading import read_json

MANIFEST = "manifest.json"
#: Most bytes of a manifest: far more than a configuration and the seconds of all blocks take.
MOST_BYTES = 50_000_000


def read_earlier_seconds(folder: Path) -> dict[str, float]:
    """Read from a run's manifest how long each block (unit of work) took in earlier sweeps.

    Return label of the block -> computing time in s. The result is empty if there is no manifest,
    or the manifest lists no valid times.
    """
    try:
        each = read_manifest(folder)["blocks"]["each"].items()
        read = {str(label): float(seconds) for label, seconds in each}
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
        return {}
    return {label: seconds for label, seconds in read.items() if isfinite(seconds)}


def read_mean_seconds(folder: Path) -> float | None:
    """Read the mean computing time of a block, s, from the manifest of earlier sweeps.

    Return None if there is no manifest, or the manifest holds no valid times.
    """
    try:
        blocks = read_manifest(folder)["blocks"]
        mean = float(blocks["seconds"]) / int(blocks["count"])
    except (ValueError, KeyError, TypeError, OverflowError, ZeroDivisionError):
        return None
    return mean if isfinite(mean) and mean >= 0.0 else None


def was_running(folder: Path) -> bool:
    """Return whether a sweep of the run in `folder` is under way, or was killed.

    The manifest's state is then "running". Return False if there is no readable manifest.
    """
    try:
        return bool(read_manifest(folder).get("state") == "running")
    except InputError:
        return False


def read_manifest(folder: Path) -> Plain:
    """Read manifest.json in a run folder; the values in the manifest are not checked.

    Raises InputError if there is no manifest, or the file cannot be read or holds no mapping.
    """
    path = folder / MANIFEST
    require(os.path.lexists(path), f"{folder}: the folder has no {MANIFEST}; run its sweep")
    manifest = read_json(path, MOST_BYTES)
    if not isinstance(manifest, dict):
        raise InputError(f"{path}: this is no manifest; run its sweep again")
    return manifest


def without_places(config: Config) -> Plain:
    """Return the configuration as a mapping without the keys `results` and `compute.scheduler`.

    A run may be published. So the run's manifest names no results folder and no scheduler's
    address.
    """
    return config.model_dump(exclude={"results": True, "compute": {"scheduler"}}, warnings=False)
