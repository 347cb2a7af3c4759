"""Makes and reads manifest.json: how a run was made, without names of users and machines.

A manifest that is read may be another person's.
"""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from math import isfinite
from pathlib import Path
from statistics import median

from owtsweep._version import __version__
from owtsweep.config import Config, Plain, require
from owtsweep.errors import InputError
from owtsweep.io.reading import read_json
from owtsweep.sweep.keys import list_versions, run_hash
from owtsweep.sweep.plan import digest
from owtsweep.sweep.study import Study

MANIFEST = "manifest.json"
#: Most bytes of a manifest: far more than a configuration and the seconds of all blocks take.
MOST_BYTES = 50_000_000
#: Packages whose version can change a number or a file.
PACKAGES = (
    "numpy", "scipy", "pandas", "pyarrow", "numba", "casadi", "filterpy", "joblib", "hydra-core",
)  # fmt: skip
CLUSTER_PACKAGES = ("dask", "distributed")
#: Up to this number of blocks, the manifest lists each block's seconds; above, a summary only.
MOST_BLOCKS = 1000
SLOWEST = 10


def start_manifest(study: Study, config: Config, text: str, **of_sweep: object) -> Plain:
    """Return the manifest of a run that begins now, as plain JSON data; `state` is "running".

    study, config: the study and its configuration.
    text: the text of config.yaml.
    of_sweep: `argv`, the arguments of the command line, or None if the run was started from Python;
        `backend` and `workers`, what runs the tasks, and the number of its workers (0: all workers
        of a cluster).
    """
    packages = (*PACKAGES, *CLUSTER_PACKAGES) if of_sweep["backend"] == "dask" else PACKAGES
    return {
        "state": "running",
        "owtsweep": __version__,  # the version of this code, even if it is not installed
        "git": git_state(Path(__file__).resolve().parents[1]),
        "python": platform.python_version(),
        "packages": {name: _find_version(name) for name in packages},
        # Not platform.node() or platform.uname(): they name the machine.
        "platform": {
            "system": platform.system(),
            "release": platform.release(),
            "machine": platform.machine(),
            "cores": os.cpu_count(),
        },
        **list_versions(study),
        "config_hash": run_hash(config),
        "config_digest": digest(text),
        "config": without_places(config),
        "seed": config.seed,
        **of_sweep,
        "started": _now(),
        "ended": None,
        "seconds": None,
        "cases": None,
        "blocks": None,
    }


def finish_manifest(
    manifest: Plain, state: str, seconds: float, cases: Plain, blocks: Mapping[str, float]
) -> Plain:
    """Return the manifest of a run that ends now.

    manifest: the manifest that `start_manifest` made.
    state: "done" if no case failed, "incomplete" if a case failed, "interrupted" after Ctrl-C, or
        "error" after another exception.
    seconds: Wall time of the sweep, s.
    cases: "computed", "reused" and "failed" -> number of cases.
    blocks: Label of a block (unit of work) -> computing time of the block, s.
    """
    return {
        **manifest,
        "state": state,
        "ended": _now(),
        "seconds": round(seconds, 3),
        "cases": cases,
        "blocks": summarise_seconds(blocks),
    }


def summarise_seconds(blocks: Mapping[str, float]) -> dict[str, object]:
    """Summarise computing times: number of blocks, sum, median, and the slowest blocks.

    `blocks` maps the label of each block (unit of work) to the block's computing time in s. The
    summary lists each block's time only if there are at most `MOST_BLOCKS` blocks.
    """
    slowest = sorted(blocks, key=lambda label: (-blocks[label], label))[:SLOWEST]
    listed = sorted(blocks) if len(blocks) <= MOST_BLOCKS else []
    return {
        "count": len(blocks),
        "seconds": round(sum(blocks.values()), 3),
        "median": round(median(blocks.values()), 4) if blocks else None,
        "slowest": {label: round(blocks[label], 4) for label in slowest},
        "each": {label: round(blocks[label], 4) for label in listed},
    }


def git_state(package: Path) -> dict[str, str | bool] | None:
    """Return the git commit of the package's sources, and whether the sources have been changed.

    The result is {"commit": hash, "dirty": whether files in src or conf differ from the commit}.
    `package` is the folder of the package. The result is None if git fails, or if this folder is
    not `src/<package>` below the root of a git repository. So a repository that only contains an
    environment with the installed package does not count.
    """
    root, _, commit = (_git(package, "rev-parse", "--show-toplevel", "HEAD") or "").partition("\n")
    if not commit or Path(root).resolve() / "src" / package.name != package:
        return None
    changes = _git(Path(root), "status", "--porcelain", "--", "src", "conf")
    return None if changes is None else {"commit": commit.strip(), "dirty": changes != ""}


@cache
def _find_version(package: str) -> str | None:
    """Return the installed version of a package; None if the package is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=10.0,
            check=True,
            # Without this git may take a lock that delays git commands of the user.
            env={**os.environ, "GIT_OPTIONAL_LOCKS": "0"},
        )
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return None
    return done.stdout


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


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
