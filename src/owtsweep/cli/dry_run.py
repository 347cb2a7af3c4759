"""`--dry-run`: say what a run would compute, in what time and memory, and stop."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import TYPE_CHECKING

from owtsweep.cli.program import DONE
from owtsweep.config import Config
from owtsweep.errors import printable

if TYPE_CHECKING:
    from owtsweep.sweep.forecast import Forecast


def foretell(configs: Sequence[Config], *, fresh: bool = False) -> int:
    """Print what runs of these configurations would do, and return 0; nothing is written.

    Raises
    ------
    InputError
        If one of the runs would refuse to start.
    """
    from owtsweep.studies import get_study
    from owtsweep.sweep.forecast import forecast

    told = [forecast(get_study(config.study), config, fresh=fresh) for config in configs]
    print("Nothing was computed or written. This command without --dry-run would do:")
    for each in told:
        print("\n".join(_describe(each)))
    if len(told) > 1:
        cases, missing = (
            sum(getattr(each, name) for each in told) for name in ("cases", "missing")
        )
        print(f"{len(told)} runs, one after the other: {cases} cases, {missing} to compute")
    return DONE


def _describe(each: Forecast) -> list[str]:
    stored = each.cases - each.missing
    return [
        f"folder  {printable(str(each.folder))}/",
        f"cases   {each.cases} in all, {stored} stored already, {each.missing} to compute",
        f"time    {_describe_time(each)}",
        f"memory  {_describe_memory(each)}",
    ]


def _describe_time(each: Forecast) -> str:
    if each.missing == 0:
        return "none but for tables and figures"
    if each.seconds is None:
        timed = each.workers > 0
        why = "no sweep has timed these blocks" if timed else "it depends on the cluster's workers"
        return f"unknown: {why}"
    basis = "as long as blocks took before in this folder"
    if each.basis == "rough":
        basis = "rough, for cores without other work; compiling comes first if it has not been done"
    workers = f"{each.workers} worker{'s' * (each.workers != 1)}"
    return f"some {_round(each.seconds)} s on {workers} ({basis})"


def _describe_memory(each: Forecast) -> str:
    return "unknown" if each.memory is None else f"some {_round(each.memory / 1e9)} GB (rough)"


def _round(value: float) -> str:
    """Return a number with one or two digits that count, without an exponent."""
    if value < 0.1:
        return "0.1"
    digits = 0 if value >= 10 else 1
    unit = 10 ** max(floor(log10(value)) - 1, -digits)
    return f"{round(value / unit) * unit:.{digits}f}"
