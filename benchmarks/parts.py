"""List the parts that are measured, in order; each part is measured by its own module.

The argument `quick` of a part's function chooses smaller sizes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Part = Callable[[bool], Any]


def _kernels(quick: bool) -> Any:
    from benchmarks.kernels import measure

    return measure(series=64, steps=5_000, repeats=5) if quick else measure()


def _reference(quick: bool) -> Any:
    from benchmarks.reference import measure

    return measure(intervals=1) if quick else measure()


def _breakdown(quick: bool) -> Any:
    from benchmarks.breakdown import measure

    return measure(duration=200.0) if quick else measure()


def _peers_filter(quick: bool) -> Any:
    from benchmarks.peers_filter import measure

    return measure()


def _peers_mhe(quick: bool) -> Any:
    from benchmarks.peers_mhe import measure

    return measure()


def _startup(quick: bool) -> Any:
    from benchmarks.startup import measure

    return measure(2 if quick else 5)


def _study(quick: bool) -> Any:
    from benchmarks.study import ROUNDS, WHOLE, axes, measure_axis, measure_long, measure_whole

    results: dict[str, Any]
    if quick:
        small = ("grid.replicates=8", "record.duration=500")
        results = {"replicates": 8, "whole": measure_whole(1, small)}
        scale, rounds = 0.1, 2
    else:
        results = {"replicates": 100, "whole": measure_whole(5, WHOLE), "long": measure_long()}
        scale, rounds = 1.0, ROUNDS
    return {**results, "axes": [measure_axis(name, rounds, scale) for name in axes()]}


def _online(quick: bool) -> Any:
    from benchmarks.online import measure

    costs = measure(steps=2_000 if quick else 20_000, repeats=2 if quick else 5)
    return [cost._asdict() for cost in costs]


def _expected(quick: bool) -> Any:
    from benchmarks.expected import measure

    return measure(("matched",)) if quick else measure()


def _bookkeeping(quick: bool) -> Any:
    from benchmarks.bookkeeping import measure

    return measure(1 if quick else 5)


PARTS: dict[str, Part] = {
    "kernels": _kernels,
    "reference": _reference,
    "breakdown": _breakdown,
    "peers_filter": _peers_filter,
    "peers_mhe": _peers_mhe,
    "startup": _startup,
    "study": _study,
    "online": _online,
    "expected": _expected,
    "bookkeeping": _bookkeeping,
}
