"""List the parts that are measured, in order, and the sizes in which each is measured.

Each part is measured by the function `measure` of the module of its name.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, NamedTuple


class Part(NamedTuple):
    """Arguments of a part's `measure`; those of a full run are its defaults."""

    quick: dict[str, Any]
    #: The smallest size, in which a test runs every part.
    least: dict[str, Any]


PARTS = {
    "kernels": Part(
        {"series": 64, "steps": 5_000, "repeats": 5}, {"series": 8, "steps": 500, "repeats": 1}
    ),
    "reference": Part({"intervals": 1}, {"intervals": 1, "repeats": 1}),
    "breakdown": Part({"duration": 200.0}, {"duration": 30.0, "repeats": 1}),
    "peers_filter": Part({}, {"duration": 33.0, "repeats": 1}),
    "peers_mhe": Part({}, {"intervals": 4, "repeats": 1}),
    "startup": Part({"repeats": 2}, {"repeats": 1}),
    "study": Part(
        {"replicates": 8, "repeats": 1, "rounds": 2, "scale": 0.1},
        {"replicates": 1, "repeats": 1, "rounds": 1, "scale": 0.02, "along": ["workers"]},
    ),
    "online": Part(
        {"steps": 2_000, "repeats": 2}, {"steps": 200, "repeats": 1, "tunings": ("matched",)}
    ),
    "expected": Part({"tunings": ["matched"]}, {"tunings": ["matched"], "repeats": 1}),
    "bookkeeping": Part({"repeats": 1}, {"repeats": 1, "blocks": 24}),
}


def measure_part(name: str, size: str = "full") -> Any:
    """Measure a part; `size` is full, quick or least. Returns what the part's `measure` returns."""
    options = {} if size == "full" else getattr(PARTS[name], size)
    return import_module(f"benchmarks.{name}").measure(**options)
