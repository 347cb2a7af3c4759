"""Draw what inclinometers buy: predicted error over their number, and where the next one pays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.figures import style
from owtsweep.studies.tower.placement import Choice, Criterion, Problem, extend

STRESS, MOMENT = "C0", "C3"
#: Errors in % that are written at the axis.
TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500)
NAMES = {"stress": "the stress at the worst weld", "moment": "the moment M0"}


def draw_placement(
    problem: Problem,
    greedy: Sequence[Choice],
    exhaustive: Sequence[Choice],
    criterion: Criterion,
    note: str,
) -> Figure:
    """Draw the figure of a choice of inclinometers.

    Parameters
    ----------
    problem
        The choice as a problem, with errors as shares of the true standard deviations.
    greedy
        Sets of sensors that were chosen one after another.
    exhaustive
        The best sets of some numbers of sensors.
    criterion
        What the sets were chosen for.
    note
        Where the numbers are from, for the bottom of the figure.
    """
    figure = style.new_figure(9.0, 4.6)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _draw_errors(left, greedy, exhaustive)
    _draw_next(figure, right, problem, greedy, criterion)
    style.footnote(figure, note)
    return figure


def _draw_errors(axes: Axes, greedy: Sequence[Choice], exhaustive: Sequence[Choice]) -> None:
    numbers = [len(choice.chosen) for choice in greedy]
    for color, label, part in ((STRESS, "stress, worst weld", 0), (MOMENT, "moment M0", 1)):
        errors = [100.0 * (choice.stress, choice.moment)[part] for choice in greedy]
        axes.plot(numbers, errors, "-o", color=color, label=f"{label}, chosen one by one")
        best = [100.0 * (choice.stress, choice.moment)[part] for choice in exhaustive]
        axes.plot(
            [len(choice.chosen) for choice in exhaustive], best, "x", color=color, ms=10, mew=1.8,
            label=f"{label}, best of all sets",
        )  # fmt: skip
    axes.set_xlabel("inclinometers")
    axes.set_ylabel("predicted error (% of the signal's std)")
    axes.set_xticks(numbers)
    axes.set_yscale("log")
    axes.margins(y=0.35)
    low, high = axes.get_ylim()
    ticks = [tick for tick in TICKS if low <= tick <= high]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_yticks([], minor=True)
    axes.legend(frameon=False, loc="center")
    axes.set_title("What inclinometers buy", loc="left")


def _draw_next(
    figure: Figure, axes: Axes, problem: Problem, greedy: Sequence[Choice], criterion: Criterion
) -> None:
    """Draw by how much a further inclinometer at each height lowers the predicted error."""
    order = np.argsort(problem.heights)
    gain = np.full((len(order), len(greedy)), np.nan)
    for column, choice in enumerate(greedy):
        for further in extend(problem, choice):
            added = (set(further.chosen) - set(choice.chosen)).pop()
            left = further.error(criterion) / choice.error(criterion)
            gain[added, column] = 100.0 * (1.0 - left)
    rows = np.arange(len(order))
    image = axes.pcolormesh(
        np.arange(len(greedy)), rows, gain[order], cmap="Blues", vmin=0.0, shading="nearest"
    )
    place = {int(number): row for row, number in enumerate(order)}
    for column, choice in enumerate(greedy):
        taken = [place[number] for number in choice.chosen]
        axes.plot([column] * len(taken), taken, "s", color="0.25", ms=6)
        if np.any(np.isfinite(gain[:, column])):
            best = int(np.nanargmax(gain[:, column]))
            axes.plot(column, place[best], "*", color="C1", ms=11)
    axes.set_xticks(range(len(greedy)), [f"{len(c.chosen)} → {len(c.chosen) + 1}" for c in greedy])
    shown = rows[:: max(1, len(rows) // 20)]
    axes.set_yticks(shown, [f"{problem.heights[order[row]]:.3g}" for row in shown])
    axes.set_xlabel("inclinometers: from → to")
    axes.set_ylabel("height above ground (m)")
    axes.grid(False)
    axes.set_title("Where the next one pays (squares: taken; star: best)", loc="left")
    figure.colorbar(image, ax=axes, label=f"error of {NAMES[criterion]} falls by (%)")
