"""Write the report in Markdown: goals first, then every part. All numbers come from the run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from benchmarks import goals, plots
from benchmarks.reference import CELLS, SETTINGS, per_cell

#: If other programs use more than this share of the machine, times are not reliable.
BUSY = 0.05


def write(results: dict[str, Any], folder: Path) -> Path:
    """Write report.md and its pictures into `folder`; return the path of report.md."""
    pictures = plots.draw(results, folder)
    path = folder / "report.md"
    path.write_text("\n".join(_lines(results, pictures)) + "\n", encoding="utf-8")
    return path


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Make the lines of a Markdown table, and the blank line after it."""
    lines = [head, ["---"] * len(head), *rows]
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]


def _lines(results: dict[str, Any], pictures: dict[str, str]) -> Iterator[str]:
    yield "# Speed\n"
    yield "Written by `python -m benchmarks` (`make bench`); nothing here is typed by hand.\n"
    yield from _machine(results)
    for part, reason in results["failed"].items():
        yield f"**{part} failed: {reason}**\n"
    for title, rows in (
        ("Must reach", goals.must_reach(results)),
        ("Also asked", goals.also_asked(results)),
    ):
        if not rows:
            continue
        yield f"## {title}\n"
        yield from table(
            ("goal", "asked", "measured", "", "why"),
            [
                (g.what, g.goal, g.measured, "-" if results["quick"] else g.verdict, _why(g))
                for g in rows
            ],
        )
    for part, write_part in SECTIONS.items():
        if part in results:
            yield from write_part(results)
            if part in pictures:
                yield f"![{part}]({pictures[part]})\n"
    yield from _versions(results)


def _why(goal: goals.Goal) -> str:
    return "" if goal.reached else goal.why


def _machine(results: dict[str, Any]) -> Iterator[str]:
    m = results["machine"]
    yield (
        f"{m['date']}, {m['CPU']}, {m['cores']} cores, last cache {m['last cache']}, memory "
        f"{m['memory']}, {m['system']}, Python {m['Python']}. Times are medians of at least 5 "
        "unless a line says otherwise.\n"
    )
    if results["quick"]:
        yield "**A quick look at smaller sizes and with fewer repeats: no verdict on any goal.**\n"
    before, after = results["busy_before"], results["busy_after"]
    shares = f"were {100 * before:.0f} % of its cores before the run, {100 * after:.0f} % after it"
    if max(before, after) > BUSY:
        yield f"**The machine was not quiet. Busy {shares}: do not trust the times.**\n"
    elif not math.isnan(before):
        yield f"The machine was quiet: busy {shares}.\n"
    yield from _peaks(results.get("kernels", []))


def _peaks(rows: list[dict[str, Any]]) -> Iterator[str]:
    """Yield a warning if n threads reach less than 0.8 n times the arithmetic peak of one thread.

    A peak that was measured too low makes the kernels' share of this peak too high.
    """
    peak = {row["threads"]: row["multiply_add_Gflop_per_s"] for row in rows}
    threads = max(peak, default=1)
    if peak and peak[threads] < 0.8 * threads * peak[1]:
        yield (
            f"**{threads} threads reach only {peak[threads] / peak[1]:.2f} times the arithmetic of "
            "one: other work ran meanwhile, or cores share their units. In the former case the "
            "shares of the machine's limits below are too high.**\n"
        )


def _kernels(results: dict[str, Any]) -> Iterator[str]:
    rows = results["kernels"]
    reference = {row["scheme"]: row["ns"] for row in results.get("reference", [])}
    yield "## Schemes: ns per IMU step and series\n"
    yield (
        "A series is one two-axis record (8 states). `batch`: the kernels alone on "
        f"{rows[0]['series']} series, tuning={rows[0]['tuning']}, sensors in memory, error sums "
        "included. `reference`: one estimator fed step by step with full windows, "
        f"{', '.join(SETTINGS)}.\n"
    )
    threads = max(row["threads"] for row in rows)
    many = {row["scheme"]: row for row in rows if row["threads"] == threads}
    yield from table(
        ("scheme", "batch, 1 thread", f"batch, {threads} threads", "reference", "ratio, 1 thread"),
        [
            (
                row["scheme"],
                f"{row['ns_median']:.2f}",
                f"{many[row['scheme']]['ns_median']:.2f}",
                f"{reference.get(row['scheme'], math.nan):.0f}",
                f"{reference.get(row['scheme'], math.nan) / row['ns_median']:.0f}",
            )
            for row in rows
            if row["threads"] == 1
        ],
    )
    if reference:
        cell = per_cell(results["reference"])
        yield (
            f"By these a cell (one record of 2000 s, four schemes) takes the reference {cell:.0f} "
            f"s, and {CELLS} cells {CELLS * cell / 3600:.1f} h. With superposition it needs two "
            f"series per record and period instead of one per cell: {12 * cell / 3600:.2f} h.\n"
        )
    yield "## Share of the machine's limits\n"
    yield (
        "Operations and bytes are counted per step and series as the algorithm needs them (the "
        "formula stands in `benchmarks/kernels.py`). The limit is max(bytes / triad, operations / "
        "peak); triad on arrays of 4 x the last cache; the peak is that of multiply-then-add (our "
        "kernels fuse nothing, so their bits do not hang on the machine). Limits and kernels take "
        "turns: *share* is the median, over rounds, of a round's limit over the same round's time; "
        "*of the best* sets the best limit of all rounds, in the table below, against the median "
        "time, so it also holds what other work on the hardware takes.\n"
    )
    yield from table(
        ("threads", "triad, GB/s", "multiply, add, Gflop/s"),
        [
            (
                n,
                f"{row['triad_GB_per_s']:.1f}",
                f"{row['multiply_add_Gflop_per_s']:.1f}",
            )
            for n, row in {row["threads"]: row for row in rows}.items()
        ],
    )
    yield from table(
        ("scheme", "threads", "operations", "bytes", "arithmetic, ns", "memory, ns", "median, ns",
         "least, ns", "share", "of the best"),
        [
            (
                row["scheme"], row["threads"], f"{row['flops']:.0f}", f"{row['bytes']:.1f}",
                f"{row['ns_arithmetic']:.2f}", f"{row['ns_memory']:.2f}", f"{row['ns_median']:.2f}",
                f"{row['ns_least']:.2f}", f"{100 * row['share']:.0f} %",
                f"{100 * row['share_of_best']:.0f} %",
            )
            for row in rows
        ],
    )  # fmt: skip


def _breakdown(results: dict[str, Any]) -> Iterator[str]:
    rows = results["breakdown"]
    total = sum(row["ms"] for row in rows)
    yield "## Where the time goes\n"
    yield (
        "Core-milliseconds per replicate of the default grid's six periods, on one core, in the "
        f"turns of a sweep: {total:.0f} ms in all. Shards and tables come on top (*Bookkeeping*).\n"
    )
    yield from table(
        ("part", "ms", "share"),
        [(r["part"], f"{r['ms']:.1f}", f"{100 * r['ms'] / total:.0f} %") for r in rows],
    )


def _peers(rows: list[dict[str, Any]], key: str, scale: float, unit: str) -> list[str]:
    ours = rows[0][key]
    return table(
        ("who", unit, "times ours", "same answer", "note"),
        [
            (row["peer"], "-", "-", "-", row["note"])
            if row[key] is None
            else (
                row["peer"],
                plots.plain(scale * row[key]),
                plots.plain(row[key] / ours),
                "yes" if row["agrees"] else "**NO**",
                row["note"],
            )
            for row in rows
        ],
    )


def _peers_filter(results: dict[str, Any]) -> Iterator[str]:
    yield "## Peers: the multirate Kalman filter\n"
    yield (
        "One two-axis record, specific force at every step and fixes at every hundredth, to "
        "filtered states; all get the same matrices and have to give our states to 1e-8 of each "
        "state's largest magnitude. The batch engine's speed comes from many series at once; the "
        "first line is one record alone, all its states kept.\n"
    )
    yield from _peers(results["peers_filter"], "ns", 1.0, "ns per step")
    for row in results.get("kernels", []):
        if row["scheme"] == "MKF" and row["threads"] == 1:
            took = row["ns_median"]
            others = [r for r in results["peers_filter"][1:] if r["ns"]]
            ratios = ", ".join(f"{r['peer']} {r['ns'] / took:.0f}" for r in others)
            yield (
                f"Against the {took:.2f} ns of the kernels on {row['series']} series (one thread, "
                f"error sums included, states not kept), times: {ratios}.\n"
            )


def _peers_mhe(results: dict[str, Any]) -> Iterator[str]:
    yield "## Peers: one window of the moving horizon estimator\n"
    yield (
        "20 fix intervals, two axes, 6 states, arrival state given, no constraints; problems "
        "built beforehand, only the data change. All have to give the closed form's newest state "
        "to 1e-4 of the largest; the largest deviation of any is "
        f"{max(r.get('error') or 0.0 for r in results['peers_mhe']):.1g}.\n"
    )
    yield from _peers(results["peers_mhe"], "seconds", 1e6, "µs per window")


def _study(results: dict[str, Any]) -> Iterator[str]:
    study = results["study"]
    whole = study["whole"]
    yield "## Whole studies\n"
    yield (
        f"{study['replicates']} replicates: {whole['process']:.2f} s as a process, "
        f"{whole['wall']:.2f} s run and aggregation, "
        f"{1e3 * whole['wall'] / study['replicates']:.0f} ms per replicate, {whole['peak']:.0f} "
        f"MB, {whole['bytes'] / 1e6:.2f} MB of shards, {whole['cases']:.0f} cases.\n"
    )
    yield (
        "Growth along each axis: times turn about in one process with gains and kernels ready, a "
        "small study as often in each turn as it takes as long as the largest; memory of a process "
        "for each. "
        "*computing*: core-seconds without shards and tables, one thread; *workers*: seconds of "
        "computing on all workers; *whole*: seconds of the run, shards and tables included. The "
        "exponent is that of computing (for the workers of the time on all of them; -1 is ideal).\n"
    )
    for axis in study["axes"]:
        yield f"{axis['axis']}: exponent {axis['exponent']:.3f}\n"
        yield from table(
            (axis["axis"], "computing, s", "all workers, s", "whole, s", "peak, MB", "shards, kB"),
            [
                (
                    f"{p['value']:g}", f"{p['compute']:.3f}", f"{p['compute_wall']:.3f}",
                    f"{p['wall']:.3f}", f"{p['peak']:.0f}", f"{p['bytes'] / 1e3:.0f}",
                )
                for p in axis["points"]
            ],
        )  # fmt: skip


def _startup(results: dict[str, Any]) -> Iterator[str]:
    yield "## Start-up\n"
    yield from table(
        ("what", "s", "note"),
        [(r["what"], f"{r['seconds']:.3f}", r["note"]) for r in results["startup"]],
    )


def _online(results: dict[str, Any]) -> Iterator[str]:
    yield "## Online: one `update` per IMU sample\n"
    yield "Microseconds per step in Python; *at once*: `run` over the whole record.\n"
    yield from table(
        ("scheme", "tuning", "median", "99.9 %", "worst", "at once"),
        [
            (
                r["scheme"], r["tuning"], f"{r['median']:.1f}", f"{r['high']:.1f}",
                f"{r['worst']:.0f}", f"{r['at_once']:.2f}",
            )
            for r in results["online"]
        ],
    )  # fmt: skip


def _bookkeeping(results: dict[str, Any]) -> Iterator[str]:
    yield "## Bookkeeping\n"
    yield "Milliseconds per block; *sum* is of what is paid once per block.\n"
    yield from table(
        ("block", "stage", "ms", "of them computing"),
        [
            (r["block"], r["stage"], f"{r['ms_per_block']:.3f}", f"{r['cpu_ms']:.3f}")
            for r in results["bookkeeping"]
        ],
    )


def _versions(results: dict[str, Any]) -> Iterator[str]:
    skip = ("date", "CPU", "cores", "last cache", "memory", "system", "Python")
    parts = [f"{name} {text}" for name, text in results["machine"].items() if name not in skip]
    yield "## Versions and time\n"
    yield ", ".join(parts) + ".\n"
    spent = ", ".join(f"{name} {value:.0f}" for name, value in results["spent"].items())
    minutes = sum(results["spent"].values()) / 60
    yield f"Seconds per part of this run: {spent}; {minutes:.1f} minutes in all."


SECTIONS = {
    "kernels": _kernels,
    "breakdown": _breakdown,
    "peers_filter": _peers_filter,
    "peers_mhe": _peers_mhe,
    "study": _study,
    "startup": _startup,
    "online": _online,
    "bookkeeping": _bookkeeping,
}
