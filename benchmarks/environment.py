"""Describe the machine for the report, without its name."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import time
from datetime import UTC, datetime
from pathlib import Path

import owtsweep
from benchmarks.machine import last_cache

PACKAGES = (
    "numpy", "scipy", "pandas", "pyarrow", "numba", "casadi", "filterpy", "statsmodels",
    "osqp", "do-mpc",
)  # fmt: skip


def describe() -> dict[str, str]:
    """Describe CPU, cores, cache, memory, software versions and date, as texts by name."""
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "CPU": _cpu(),
        "cores": str(os.cpu_count()),
        "last cache": f"{last_cache() / 2**20:.0f} MiB",
        "memory": _memory(),
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "owtsweep": owtsweep.__version__,
        **{name: _version(name) for name in PACKAGES},
    }


def busy(seconds: float = 1.0) -> float:
    """Measure which share (0 to 1) of all cores other programs use, while this process sleeps.

    Returns NaN if the system does not tell.
    """
    try:
        before = _jiffies()
        time.sleep(seconds)
        after = _jiffies()
    except OSError:
        return float("nan")
    spent = [b - a for a, b in zip(before, after, strict=True)]
    return 1.0 - (spent[3] + spent[4]) / max(1, sum(spent))


def _jiffies() -> list[int]:
    first = Path("/proc/stat").read_text().splitlines()[0]
    return [int(word) for word in first.split()[1:9]]


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    names = {line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")}
    return ", ".join(sorted(names)) or "unknown"


def _memory() -> str:
    try:
        total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError):
        return "unknown"
    return f"{total / 2**30:.0f} GiB"


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
