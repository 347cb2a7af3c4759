"""Distributions of errors over records: the boxes are those of the records' errors."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from soil_study import FACTOR, GRID, NOISE, SCHEMES, SOIL, make_rows

from owtsweep.errors import InputError
from owtsweep.figures import distributions
from owtsweep.figures.palette import style_of
from owtsweep.results.cube import Cube


def make_cube(conditions, *, replicates: int) -> Cube:
    rows = make_rows(conditions, replicates=replicates)
    return Cube.of_rows(rows, SCHEMES, conditions, GRID)


def draw(cube: Cube) -> Figure:
    told = {"title": "Errors", "tuning": "paper", "label": "strain"}
    return distributions.draw(cube, "strain", "full", **told)


@pytest.mark.parametrize("replicates", [5, 40])
def test_boxes_are_of_the_errors_of_single_records(replicates):
    conditions = (FACTOR, NOISE)
    cube = make_cube(conditions, replicates=replicates)
    errors = distributions.collect(cube, "strain", "full")
    assert len(errors) == 3 * 2 * len(SCHEMES) * replicates
    figure = draw(cube)
    assert len(figure.axes) == 6
    for place, axes in enumerate(figure.axes):
        factor, noise = GRID["soil_factor"][place % 3], GRID["noise"][1 - place // 3]
        assert axes.get_title("left") == f"soil factor {factor:g}, noise {noise:g} %"
        assert axes.get_xscale() == "log"
        boxes = axes.patches
        if place % 3 == 0:  # the others share its labels
            assert [label.get_text() for label in axes.get_yticklabels()] == list(SCHEMES)
        here = errors[(errors["soil_factor"] == factor) & (errors["noise"] == noise)]
        for name, box, drawn in zip(SCHEMES, boxes, axes.containers, strict=True):
            own = here.loc[here["scheme"] == name, "error"].sort_values().to_numpy()
            low, high = np.percentile(own, [25.0, 75.0])
            assert box.get_path().get_extents().x0 == pytest.approx(low)
            assert box.get_path().get_extents().x1 == pytest.approx(high)
            assert to_hex(box.get_facecolor()) == style_of(name, SCHEMES).color.lower()
            ((mean,),) = (line.get_xdata() for line in drawn.means)
            assert mean == pytest.approx(own.mean())  # not of the logarithms
            low, high = np.percentile(own, [5.0, 95.0])
            inside = (own >= low) & (own <= high)
            ends = sorted(line.get_xdata()[1] for line in drawn.whiskers)
            assert ends == pytest.approx([own[inside].min(), own[inside].max()])
            beyond = [dot for line in drawn.fliers for dot in sorted(line.get_xdata())]
            assert beyond == pytest.approx([] if replicates == 5 else own[~inside])
        records = [points.get_offsets().data.T for points in axes.collections]
        assert len(records) == (len(SCHEMES) if replicates == 5 else 0)  # more would be a blot
        for name, (places, heights) in zip(SCHEMES, records, strict=False):
            own = here.loc[here["scheme"] == name, "error"]
            assert np.sort(places) == pytest.approx(own.sort_values().to_numpy())
            assert len(set(heights)) == 1


def test_the_cells_are_the_first_the_middle_and_the_last():
    conditions = (SOIL,)
    cube = make_cube(conditions, replicates=4)
    errors = distributions.collect(cube, "strain", "full")
    assert list(dict.fromkeys(errors["soil"])) == ["sand", "clay", "rock"]
    figure = draw(cube)
    assert [axes.get_title("left") for axes in figure.axes] == [
        "soil sand", "soil clay", "soil rock",
    ]  # fmt: skip
    assert distributions._choose(10) == [0, 5, 9]
    assert distributions._choose(2) == [0, 1]


def test_each_window_has_its_own_errors():
    rows = make_rows((SOIL,), replicates=4)
    settled = rows.assign(window="settled", value=0.1 * rows["value"])
    cube = Cube.of_rows(pd.concat([settled, rows]), SCHEMES, (SOIL,), GRID)
    full, less = (
        distributions.collect(cube, "strain", window)["error"] for window in ("full", "settled")
    )
    assert less.to_numpy() == pytest.approx(0.1 * full.to_numpy())


def test_few_records_have_no_distribution():
    cube = make_cube((SOIL,), replicates=3)
    with pytest.raises(InputError, match=r"^grid.replicates: .* 4 records .* this run has 3$"):
        distributions.collect(cube, "strain", "full")
