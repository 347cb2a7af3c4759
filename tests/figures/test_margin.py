"""The fill of a map shows the margin, and text on it is readable."""

from __future__ import annotations

import math

import numpy as np
import pytest
from looks import LOOKS
from matplotlib.colors import to_rgb
from matplotlib.patches import Rectangle

from owtsweep.figures import style
from owtsweep.figures.margin import (
    EXPLANATION,
    FULL,
    PALEST,
    add_legend,
    fill_cell,
    fill_regions,
    make_entry,
    ratio_of,
    share_of_color,
)
from owtsweep.figures.palette import relative_luminance, style_of, text_color_on


def test_the_share_grows_with_the_logarithm_from_a_tie_to_full():
    ratios = [1.0, math.sqrt(FULL), FULL, 100.0 * FULL, math.nan, math.inf]
    expected = [PALEST, (1.0 + PALEST) / 2.0, 1.0, 1.0, 1.0, 1.0]
    assert share_of_color(ratios) == pytest.approx(expected)
    assert 0.2 < PALEST < 0.5  # a tie still has the scheme's hue
    assert fill_cell(LOOKS["HME1"], FULL) == LOOKS["HME1"].color


def test_text_on_every_fill_has_a_contrast_of_at_least_4_5():
    names = [*LOOKS, *(f"user{number}" for number in range(20))]
    for name in names:
        for ratio in np.geomspace(1.0, FULL, 60):
            fill = fill_cell(style_of(name, names), ratio)
            low, high = sorted(map(relative_luminance, (fill, text_color_on(fill))))
            assert (high + 0.05) / (low + 0.05) >= 4.5, (name, ratio)


@pytest.mark.parametrize(
    ("best", "runner_up", "ratio"),
    [(2.0, 3.0, 1.5), (2.0, math.nan, math.nan), (0.0, 1.0, math.nan)],
)
def test_the_ratio_of_a_cell(best, runner_up, ratio):
    row = {"error_best": best, "error_runner_up": runner_up}
    assert ratio_of(row) == pytest.approx(ratio, nan_ok=True)


def test_a_fine_map_has_the_fills_of_its_cells():
    looks = [LOOKS["MKF"], LOOKS["HME1"]]
    best, ratio = (
        np.array([[0, 1, 1], [1, 0, 0]]),
        np.array([[1.0, 2.0, 9.0], [3.0, 1.1, math.nan]]),
    )
    fill = fill_regions(best, ratio, [look.color for look in looks])
    assert fill.shape == (3, 2, 3)
    for place in np.ndindex(best.shape):
        cell = to_rgb(fill_cell(looks[best[place]], ratio[place]))
        assert fill[place[::-1]] == pytest.approx(cell, abs=0.5 / 255.0 + 1e-9)


def test_the_legend_shows_the_shades_and_explains_them():
    with style.context():
        figure = style.new_figure(4.0, 2.0)
        add_legend(figure, [make_entry("MKF", ["MKF"])], columns=1)
    legend = figure.legends[0]
    assert f"{FULL:g} times" in legend.get_title().get_text()
    figure.draw_without_rendering()
    strip = [patch.get_facecolor()[:3] for patch in legend.findobj(Rectangle)]
    assert strip[0] == pytest.approx(to_rgb(fill_cell(LOOKS["MKF"], 1.0)), abs=0.01)
    assert strip[-1] == pytest.approx(to_rgb(LOOKS["MKF"].color))


def test_the_origin_stands_above_the_legend_not_on_it():
    with style.context():
        figure = style.new_figure(6.0, 3.0)
        figure.add_subplot().set_title("map", loc="left")
        add_legend(figure, [make_entry("MKF", ["MKF"])], columns=1)
        style.add_origin(figure, "Truth: records of 1000 s")
        figure.draw_without_rendering()
    origin, explanation = figure.legends[0].get_title().get_text().splitlines()
    assert (origin, explanation) == ("Truth: records of 1000 s", EXPLANATION)
    assert not figure.get_suptitle()
