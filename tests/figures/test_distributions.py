"""Distributions of errors over records: the boxes are those of the records' errors."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_hex

from owtsweep.errors import InputError
from owtsweep.figures import distributions
from owtsweep.figures.palette import style_of
from owtsweep.results.cube import Cube
from soil_study import FACTOR, GRID, NOISE, SCHEMES, SOIL, make_rows


def make_cube(conditions, *, replicates: int) -> Cube:
    rows = make_rows(conditions, replicates=replicates)
    return Cube.of_rows(rows, SCHEMES, conditions, GRID)


@pytest.mark.parametrize("replicates", [5, 40])
def test_boxes_are_of_the_errors_of_single_records(replicates):
    conditions = (FACTOR, NOISE)
    cube = make_cube(conditions, replicates=replicates)
    errors = distributions.collect(cube, "strain", "full")
    assert len(errors) == 3 * 2 * len(SCHEMES) * replicates
    figure = distributions.draw(errors, SCHEMES, conditions, title="Errors", label="strain")
    assert len(figure.axes) == 6
    for place, axes in enumerate(figure.axes):
        factor, noise = GRID["soil_factor"][place % 3], GRID["noise"][1 - place // 3]
        assert axes.get_title("left") == f"soil factor {factor:g}, noise {noise:g} %"
        assert axes.get_xscale() == "log"
        boxes = axes.patches
        if place % 3 == 0:  # the others share its labels
            assert [label.get_text() for label in axes.get_yticklabels()] == list(SCHEMES)
        means = [line for line in axes.get_lines() if line.get_marker() == "D"]
        here = errors[(errors["soil_factor"] == factor) & (errors["noise"] == noise)]
        for name, box, mean in zip(SCHEMES, boxes, means, strict=True):
            own = here.loc[here["scheme"] == name, "error"]
            low, high = np.percentile(own, [25.0, 75.0])
            assert box.get_path().get_extents().x0 == pytest.approx(low)
            assert box.get_path().get_extents().x1 == pytest.approx(high)
            assert mean.get_xdata() == pytest.approx([own.mean()])  # not of the logarithms
            assert to_hex(box.get_facecolor()) == style_of(name, SCHEMES).color.lower()


def test_the_cells_are_the_first_the_middle_and_the_last():
    conditions = (SOIL,)
    errors = distributions.collect(make_cube(conditions, replicates=4), "strain", "full")
    assert list(dict.fromkeys(errors["soil"])) == ["sand", "clay", "rock"]
    figure = distributions.draw(errors, SCHEMES, conditions, title="Errors", label="strain")
    assert [axes.get_title("left") for axes in figure.axes] == [
        "soil sand", "soil clay", "soil rock",
    ]  # fmt: skip
    assert distributions._choose(10) == [0, 5, 9]
    assert distributions._choose(2) == [0, 1]


def test_few_records_have_no_distribution():
    cube = make_cube((SOIL,), replicates=3)
    with pytest.raises(InputError, match=r"^grid.replicates: .* 4 records .* this run has 3$"):
        distributions.collect(cube, "strain", "full")
