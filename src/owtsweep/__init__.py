"""owtsweep: run estimation schemes under many conditions, and map which scheme is best where.

The names in `__all__` are the public interface, with those of `owtsweep.schemes` and
`owtsweep.testing`, and those that docs/api.md lists for a study of one's own; everything else is
private. Each of these names is imported on its first use, so importing the package is fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from owtsweep._version import __version__
from owtsweep.errors import InputError

if TYPE_CHECKING:
    from owtsweep.advice.advising import Advice
    from owtsweep.api import advise, estimate, load, online, replay, run
    from owtsweep.evaluation.estimate import Estimate, EstimatedRecord, Innovation, Reading
    from owtsweep.studies.replay.running import Replay
    from owtsweep.sweep.runs import Run

__all__ = [
    "Advice", "Estimate", "EstimatedRecord", "Innovation", "InputError", "Reading", "Replay",
    "Run", "__version__", "advise", "estimate", "load", "online", "replay", "run",
]  # fmt: skip

_HOMES = {
    **dict.fromkeys(("advise", "estimate", "load", "online", "replay", "run"), "owtsweep.api"),
    **dict.fromkeys(
        ("Estimate", "EstimatedRecord", "Innovation", "Reading"), "owtsweep.evaluation.estimate"
    ),
    "Advice": "owtsweep.advice.advising",
    "Replay": "owtsweep.studies.replay.running",
    "Run": "owtsweep.sweep.runs",
}


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
