"""manifest.json: what made a run, without saying who or where."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Sequence
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Literal

from owtsweep.config import Config
from owtsweep.studies.base import Study
from owtsweep.sweep.keys import run_hash

#: Packages whose version can change a number or a file.
PACKAGES = (
    "numpy",
    "scipy",
    "pandas",
    "pyarrow",
    "numba",
    "casadi",
    "filterpy",
    "joblib",
    "hydra-core",
)

#: How a run ended: all cases done, some failed, Ctrl-C, or an exception.
State = Literal["done", "incomplete", "interrupted", "error"]


def start_manifest(
    study: Study,
    config: Config,
    *,
    argv: Sequence[str] | None,
    backend: str,
    workers: int,
) -> dict[str, Any]:
    """The manifest of a run that begins now, ready for JSON; `state` is "running".

    Parameters
    ----------
    study, config
        What is run.
    argv
        The command line as given, or None when the run was started from Python.
    backend, workers
        The joblib backend and how many workers it gets.
    """
    return {
        "state": "running",
        "owtsweep": package_version("owtsweep"),
        "git": git_state(Path(__file__).resolve().parents[1]),
        "python": platform.python_version(),
        "packages": {name: package_version(name) for name in PACKAGES},
        # Not platform.node() or platform.uname(): they name the machine.
        "platform": {
            "system": platform.system(),
            "release": platform.release(),
            "machine": platform.machine(),
            "cores": os.cpu_count(),
        },
        **shard_metadata(study),
        "config_hash": run_hash(config),
        "seed": config.seed,
        "argv": None if argv is None else list(argv),
        "backend": backend,
        "workers": workers,
        "started": _now(),
        "ended": None,
        "seconds": None,
        "cases": None,
    }


def finish_manifest(
    manifest: dict[str, Any],
    *,
    state: State,
    seconds: float,
    computed: int,
    reused: int,
    failed: int,
) -> dict[str, Any]:
    """The manifest of a run that ends now, after `seconds`; the counts are cases."""
    return {
        **manifest,
        "state": state,
        "ended": _now(),
        "seconds": round(seconds, 3),
        "cases": {"computed": computed, "reused": reused, "failed": failed},
    }


def shard_metadata(study: Study) -> dict[str, str | int]:
    """The versions that decide whether a shard is still what this program would compute."""
    return {
        "study": study.name,
        "schema_version": study.schema_version,
        "numerics_version": study.numerics_version,
    }


@cache
def package_version(name: str) -> str | None:
    """The installed version of a package, or None, e.g. for a checkout that is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def git_state(package: Path) -> dict[str, str | bool] | None:
    """The commit, and whether the sources differ from it; None unless run from a checkout.

    `package` is the folder of the package; a repository that merely holds the environment in which
    the package is installed is not its checkout.
    """
    root = _git(package, "rev-parse", "--show-toplevel")
    if not root or Path(root.strip()).resolve() / "src" / package.name != package:
        return None
    commit = _git(package, "rev-parse", "--verify", "HEAD")
    changes = _git(Path(root.strip()), "status", "--porcelain", "--", "src", "conf")
    if not commit or changes is None:
        return None
    return {"commit": commit.strip(), "dirty": changes != ""}


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=10.0,
            check=True,
            # Looking must not take the lock that a user's own git command waits for.
            env={**os.environ, "GIT_OPTIONAL_LOCKS": "0"},
        )
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return None
    return done.stdout


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
