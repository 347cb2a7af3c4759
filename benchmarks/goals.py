"""Compare the goals with the measured numbers: reached, or missed and why."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from benchmarks.kernels import SHARE, tell_loss
from benchmarks.reference import CELLS, per_cell

#: Greatest time of a kernel in ns per step and series on one thread.
NANOSECONDS = {"MKF": 8.0, "HME1": 30.0, "HME2": 40.0}
WALL, MEGABYTES, FASTER, STANDS_ALONE = 35.0, 1000.0, 20_000.0, 100.0
EXPONENT = (0.95, 1.05)


class Goal(NamedTuple):
    """One goal: what is measured, the goal, the result, whether it was reached, and why not.

    `reached` is None if the goal does not apply.
    """

    what: str
    goal: str
    measured: str
    reached: bool | None
    why: str = ""

    @property
    def verdict(self) -> str:
        """The outcome in words: "reached", "MISSED" or "does not apply"."""
        return "does not apply" if self.reached is None else "reached" if self.reached else "MISSED"


def must_reach(results: dict[str, Any]) -> list[Goal]:
    """Return the goals of the report's first table, for the parts that were measured."""
    return [
        *_study(results),
        *_faster(results),
        *_kernels(results),
        *_growth(results),
        *_startup(results),
    ]


def also_asked(results: dict[str, Any]) -> list[Goal]:
    """Return the goals of the report's second table, for the parts that were measured."""
    return [
        *_long_records(results), *_threads(results), *_map(results), *_online(results),
        *_books(results),
    ]  # fmt: skip


def _study(results: dict[str, Any]) -> Iterator[Goal]:
    if "study" not in results:
        return
    whole, count = results["study"]["whole"], results["study"]["replicates"]
    took, peak = whole["process"], whole["peak"]
    yield Goal(
        f"{'study of the quick look' if results['quick'] else 'default grid, 2000 s'}, {count} "
        "replicates, four schemes, run and aggregation without figures, kernels warm",
        f"{WALL:g} s",
        f"{took:.1f} s, a process from start to end ({whole['wall']:.1f} s without start and "
        "imports)",
        took <= WALL,
        f"{took / WALL:.2f} times the goal; the parts are under *Where the time goes*",
    )
    yield Goal(
        "its memory",
        "under 1 GB",
        f"{peak:.0f} MB at its peak",
        peak < MEGABYTES,
        "the peak of the whole process, compiled kernels and libraries included",
    )


def _faster(results: dict[str, Any]) -> Iterator[Goal]:
    if not {"study", "reference"} <= results.keys():
        return
    cell = per_cell(results["reference"])
    ours = results["study"]["whole"]["wall"] / results["study"]["replicates"]
    ratio = CELLS * cell / ours
    shown = (
        f"{1e3 * round(1e-3 * ratio):.0f} times: {cell:.0f} s per cell, "
        f"{CELLS * cell / 3600:.1f} h per replicate of {CELLS} cells, against {ours:.3f} s"
    )
    alone = cell < STANDS_ALONE
    why = f"that leaves {CELLS * cell / FASTER:.3f} s per replicate"
    if alone:
        why = f"a cell takes less than {STANDS_ALONE:.0f} s: the goal of {WALL:g} s stands alone"
    yield Goal(
        "per replicate against `engine=reference` (N_s = 20, N_m = 20, T_m = 0.1 s)",
        "20000 times faster",
        shown,
        None if alone else ratio >= FASTER,
        why,
    )


def _kernels(results: dict[str, Any]) -> Iterator[Goal]:
    rows = results.get("kernels", [])
    for row in rows:
        most = NANOSECONDS.get(row["scheme"])
        if row["threads"] == 1 and most is not None:
            took = row["ns_median"]
            yield Goal(
                f"batched {row['scheme']} per IMU step of one two-axis record, one thread, "
                f"{row['series']} series, error sums included",
                f"{most:g} ns",
                f"{took:.2f} ns",
                took <= most,
                f"{took / most:.2f} times the goal; its limits are {row['ns_arithmetic']:.2f} ns "
                f"(arithmetic) and {row['ns_memory']:.2f} ns (memory)",
            )
    threads = max((row["threads"] for row in rows), default=1)
    for row in rows:
        if row["scheme"] in NANOSECONDS and row["threads"] == threads:
            (single,) = (r for r in rows if r["scheme"] == row["scheme"] and r["threads"] == 1)
            kind = "arithmetic" if row["ns_arithmetic"] >= row["ns_memory"] else "memory"
            limit = max(row["ns_arithmetic"], row["ns_memory"])
            yield Goal(
                f"{row['scheme']}'s kernels against max(bytes / triad, operations / multiply-add "
                f"peak), {threads} threads",
                f"at least {100 * SHARE:.0f} %",
                f"{100 * row['share']:.0f} %: {row['ns_median']:.2f} ns; at best the limit was "
                f"{limit:.2f} ns ({kind}), {100 * row['share_of_best']:.0f} %",
                row["share"] >= SHARE,
                f"one thread reaches {100 * single['share']:.0f} % of its own limit and {threads} "
                f"threads are {single['ns_median'] / row['ns_median']:.2f} times as fast as one. "
                f"{tell_loss(row)}",
            )


def _growth(results: dict[str, Any]) -> Iterator[Goal]:
    for axis in results.get("study", {}).get("axes", []):
        if axis["axis"] not in ("replicates", "duration"):
            continue
        points = axis["points"]
        ratio = points[-1]["compute"] / points[0]["compute"]
        yield Goal(
            f"compute seconds against {axis['axis']}: exponent",
            "0.95-1.05",
            f"{axis['exponent']:.3f}",
            EXPONENT[0] <= axis["exponent"] <= EXPONENT[1],
            f"{points[-1]['value'] / points[0]['value']:g} times as much takes {ratio:.2f} times "
            f"as long ({points[0]['compute']:.3f} s to {points[-1]['compute']:.3f} s)",
        )


def _startup(results: dict[str, Any]) -> Iterator[Goal]:
    for row in results.get("startup", []):
        if row["goal"] is not None:
            yield Goal(
                row["what"],
                f"under {row['goal']:g} s",
                f"{row['seconds']:.3f} s",
                row["seconds"] < row["goal"],
                row["note"],
            )


def _long_records(results: dict[str, Any]) -> Iterator[Goal]:
    peak = results.get("study", {}).get("long")
    if peak is not None:
        yield Goal(
            "memory of a study of 16 000 s: one period, two workers, 16 replicates",
            "under 1 GB",
            f"{peak:.0f} MB at its peak",
            peak < MEGABYTES,
            "each worker holds `hub.sizes.MEMORY_SHARE` bytes of motion; all of them share the "
            "gains, which are kept step by step up to 2621 s (tuning=paper)",
        )


def _threads(results: dict[str, Any]) -> Iterator[Goal]:
    for axis in results.get("study", {}).get("axes", []):
        if axis["axis"] == "workers" and len(axis["points"]) > 1:
            one, two = axis["points"][0], axis["points"][-1]
            ratio = one["compute_wall"] / two["compute_wall"]
            yield Goal(
                f"{two['value']:g} workers against one, computing",
                f"{0.9 * two['value']:g} times",
                f"{ratio:.2f} times ({one['wall'] / two['wall']:.2f} with shards and tables)",
                ratio >= 0.9 * two["value"],
                "the workers share memory bandwidth and the interpreter's lock",
            )


def _map(results: dict[str, Any]) -> Iterator[Goal]:
    for row in results.get("expected", []):
        yield Goal(
            f"`engine=expected`, 200 x 200 cells, tuning={row['tuning']}, curves known",
            "under 2 s",
            f"{row['files']:.2f} s from files, {row['memory']:.2f} s from memory",
            row["files"] < 2.0,
            "curves are read and the map is judged",
        )
        yield Goal(
            "the same, nothing known (measured once)",
            "under 2 s",
            f"{row['nothing']:.1f} s",
            row["nothing"] < 2.0,
            "the schemes' curves are computed, once per tuning, and kept in files",
        )


def _online(results: dict[str, Any]) -> Iterator[Goal]:
    for row in results.get("online", []):
        if row["scheme"] == "HME2":
            yield Goal(
                f"online HME2 per IMU step, tuning={row['tuning']}: median",
                "at most 200 µs",
                f"{row['median']:.1f} µs (99.9 %: {row['high']:.0f} µs)",
                row["median"] <= 200.0,
            )


def _books(results: dict[str, Any]) -> Iterator[Goal]:
    for row in results.get("bookkeeping", []):
        if row["stage"] == "sum" and row["block"].startswith("hub"):
            yield Goal(
                "planning and bookkeeping per block",
                "under 2 ms",
                f"{row['ms_per_block']:.2f} ms, of them {row['cpu_ms']:.2f} ms computing",
                row["ms_per_block"] < 2.0,
                "what is not computing waits for the disk: two flushes per block",
            )
