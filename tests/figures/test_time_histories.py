"""Lines over time, the panels that hold them, and the panels of errors."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.figures import time_histories
from owtsweep.figures.lines import POINTS, clip, make_line, make_pair
from owtsweep.figures.time_histories import Band, Curve, Level, Panel, show_accumulated, show_errors

TIME = np.arange(0.0, 10.0, 0.1)
NAMES = ["one", "other"]


def test_a_gap_stays_a_gap():
    values = np.sin(TIME)
    values[20:30] = np.nan
    (first, _), (second, shown) = make_line(TIME, values)
    assert first[-1] == TIME[19]
    assert second[0] == TIME[30]
    assert shown.tolist() == values[30:].tolist()
    assert make_line(TIME, np.full(len(TIME), np.nan)) == []


def test_a_long_line_keeps_its_extremes_and_few_points():
    time = np.arange(50_000.0)
    values = np.random.default_rng(0).standard_normal(50_000)
    x, y = make_pair(time, np.stack([values, -values], axis=1))
    assert len(x[0][0]) <= POINTS + 2
    assert x[0][1].max() == values.max()
    assert y[0][1].min() == -values.max()


def test_a_view_holds_its_ends():
    time, values = clip(TIME, 2.0 * TIME, (1.0, 2.0))
    assert time == pytest.approx(np.arange(1.0, 2.05, 0.1))
    assert values.tolist() == (2.0 * time).tolist()


def test_panels_stand_below_each_other_and_the_first_makes_the_legend():
    line = make_line(TIME, np.sin(TIME))
    upper = Panel(
        "x position (m)",
        [
            time_histories.show_measurement(line),
            time_histories.show_truth(line),
            time_histories.show_estimate("one", NAMES, line),
            time_histories.show_fixes(TIME[::10], np.sin(TIME[::10]), label="fixes", size=6),
        ],
        view=(0.0, 5.0),
        note="a note",
    )
    band = Band(TIME, -np.ones(len(TIME)), np.ones(len(TIME)), "red")
    lower = Panel("error", [band, Level(0.0), Level(1.0, bound=True)], (0.0, 5.0), (-2.0, None))
    figure = time_histories.draw(
        [upper, lower], title="A title", footnote="A footnote.", shared=True
    )
    first, second = figure.axes
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["IMU", "truth", "one", "fixes"]
    assert first.get_title(loc="left") == "a note"
    assert first.get_xlim() == second.get_xlim() == (0.0, 5.0)
    assert second.get_ylim()[0] == -2.0
    assert [line.get_linestyle() for line in second.get_lines()] == ["-", ":"]
    assert second.get_xlabel() == "time (s)"


def test_accumulated_errors_are_the_sum_over_time_and_axes():
    error = np.stack([np.sin(TIME), np.cos(TIME)], axis=1)
    panel = show_accumulated({"one": (TIME, error)}, NAMES, "velocity", 12.0)
    total = 0.1 * np.abs(error).sum()
    assert panel.marks[0].line[0][1][-1] == pytest.approx(total)
    assert panel.note == f"over the whole record; at its end: one {total:.3g} m"
    assert panel.view == (0.0, 12.0)
    assert panel.label.endswith("x + y (m)")


def test_errors_of_x_lie_in_the_view_between_the_bounds():
    error = np.stack([np.sin(TIME), np.cos(TIME)], axis=1)
    panel = show_errors({"one": (TIME, error)}, NAMES, "position", (1.0, 2.0), bound=0.5)
    curve, *levels = panel.marks
    assert isinstance(curve, Curve)
    assert curve.line[0][1].tolist() == error[(TIME >= 1.0) & (TIME <= 2.0), 0].tolist()
    assert [level.value for level in levels] == [-0.5, 0.5, 0.0]
