"""Draw the report's pictures: schemes, limits, where the time goes, peers, growth."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.kernels import SHARE
from owtsweep.figures.style import context, new_figure
from owtsweep.studies.hub.contract import LISTED

OURS, OTHERS, LIMIT = "#0072B2", "#999999", "#D55E00"
DPI = 100


def plain(value: float) -> str:
    """Format a number to three significant digits, without an exponent."""
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    return f"{round(value, digits):,.10g}".replace(",", " ")


def draw(results: dict[str, Any], folder: Path) -> dict[str, str]:
    """Draw and save the pictures of the parts that were measured; return file names by part."""
    files = {}
    with context():
        for part, picture in PICTURES.items():
            if part in results:
                name = f"{part}.png"
                picture(results).savefig(folder / name, dpi=DPI)
                files[part] = name
    return files


def _kernels(results: dict[str, Any]) -> Any:
    """Draw ns per step in both engines (left), and the kernels' share of the limits (right)."""
    figure = new_figure(10.0, 3.8)
    left, right = figure.subplots(1, 2)
    rows = results["kernels"]
    single = [row for row in rows if row["threads"] == 1]
    names = [row["scheme"] for row in single]
    engines = [("batch", OURS, [row["ns_median"] for row in single])]
    if "reference" in results:
        engines.append(("reference", OTHERS, [row["ns"] for row in results["reference"]]))
    at = np.arange(len(names))
    for i, (engine, color, values) in enumerate(engines):
        bars = left.bar(at + 0.4 * i - 0.2, values, 0.38, color=color, label=engine)
        left.bar_label(bars, [plain(value) for value in values], fontsize=8)
    left.set(yscale="log", xticks=at, xticklabels=names, ylabel="ns per step and series")
    left.set_title("One thread, one two-axis record")
    left.margins(y=0.15)
    left.legend(loc="upper left")

    threads = max(row["threads"] for row in rows)
    for i, n in enumerate(sorted({1, threads})):
        shares = [100 * row["share"] for row in rows if row["threads"] == n]
        label = "1 thread" if n == 1 else f"{n} threads"
        bars = right.bar(at + 0.4 * i - 0.2, shares, 0.38, color=(OURS, "#56B4E9")[i], label=label)
        right.bar_label(bars, [f"{share:.0f}" for share in shares], fontsize=8)
    goal = 100 * SHARE
    label = f"goal, all threads: {goal:.0f} %"
    right.axhline(goal, color=LIMIT, linestyle="--", label=label)
    right.set(xticks=at, xticklabels=names, ylim=(0, 135), yticks=range(0, 101, 20))
    right.set(ylabel="% of bandwidth or arithmetic peak")
    right.set_title("The kernels' limit over their time")
    right.legend(loc="upper center", ncols=3, fontsize=8)
    return figure


def _breakdown(results: dict[str, Any]) -> Any:
    """Draw core-milliseconds per replicate, one bar per part."""
    rows = results["breakdown"]
    figure = new_figure(9.0, 2.9)
    ax = figure.subplots()
    colors = [
        look.color if scheme is not None and (look := scheme.look) is not None else "0.6"
        for scheme in (LISTED.get(row["part"].split(":")[0]) for row in rows)
    ]
    values = [row["ms"] for row in rows]
    bars = ax.barh([row["part"] for row in rows], values, color=colors)
    total = sum(values)
    ax.bar_label(bars, [f"{v:.1f} ({100 * v / total:.0f} %)" for v in values], padding=3)
    ax.invert_yaxis()
    ax.margins(x=0.18)
    ax.set(xlabel="core-milliseconds per replicate of six periods")
    ax.set_title("Where the time goes: one replicate of the default grid")
    return figure


def _peers(rows: list[dict[str, Any]], key: str, scale: float, unit: str, title: str) -> Any:
    rows = [row for row in rows if row[key] is not None]
    figure = new_figure(9.0, 0.9 + 0.42 * len(rows))
    ax = figure.subplots()
    values = [scale * row[key] for row in rows]
    names = [row["peer"] + ("" if row["agrees"] else " (other answer)") for row in rows]
    bars = ax.barh(names, values, color=[OURS, *[OTHERS] * (len(rows) - 1)])
    ax.bar_label(bars, [f"{plain(v)} (x {plain(v / values[0])})" for v in values], padding=3)
    ax.invert_yaxis()
    ax.set(xscale="log", xlabel=unit)
    ax.margins(x=0.35)
    ax.set_title(title)
    return figure


def _peers_filter(results: dict[str, Any]) -> Any:
    return _peers(
        results["peers_filter"], "ns", 1.0, "ns per step",
        "Multirate Kalman filter, one two-axis record, same states",
    )  # fmt: skip


def _peers_mhe(results: dict[str, Any]) -> Any:
    return _peers(
        results["peers_mhe"], "seconds", 1e6, "µs per window",
        "One MHE window of 20 fix intervals, same solution",
    )  # fmt: skip


def _study(results: dict[str, Any]) -> Any:
    """Draw the time against replicates, duration and workers, on log-log axes with slopes."""
    measured = results["study"]["axes"]
    figure = new_figure(2.75 * len(measured), 3.2)
    axes = figure.subplots(1, len(measured), sharey=True)
    units = {"duration": "duration, s"}
    for ax, axis in zip(axes, measured, strict=True):
        x = [point["value"] for point in axis["points"]]
        key = "compute_wall" if axis["axis"] == "workers" else "compute"
        computing = [point[key] for point in axis["points"]]
        ax.plot(x, computing, "o-", color=OURS, label="computing")
        ax.plot(
            x, [point["wall"] for point in axis["points"]], "s--", color=LIMIT, label="whole run"
        )
        ax.set(xscale="log", yscale="log", xlabel=units.get(axis["axis"], axis["axis"]))
        ax.set_xticks(x, [f"{value:g}" for value in x])
        ax.minorticks_off()
        slope = axis["exponent"]
        ax.set_title(f"{axis['axis']}: slope {slope:.2f}")
    low, high = axes[0].get_ylim()
    ticks = [n * 10.0**k for k in range(-2, 4) for n in (1, 2, 5)]
    ticks = [tick for tick in ticks if low <= tick <= high]
    axes[0].set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes[0].minorticks_off()
    axes[0].set_ylabel("seconds")
    axes[0].legend(loc="upper left")
    return figure


PICTURES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "kernels": _kernels,
    "breakdown": _breakdown,
    "peers_filter": _peers_filter,
    "peers_mhe": _peers_mhe,
    "study": _study,
}
