"""The axes of maps: two conditions, one, or more of which two vary."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from owtsweep.errors import InputError
from owtsweep.figures.plane import Plane
from owtsweep.results.conditions import Condition
from owtsweep.studies.hub.worlds import CONDITIONS

SOIL, DEPTH = Condition("soil", "soil"), Condition("depth", "depth", "m")
NOISE = Condition("noise", "noise", "%")


def plane(amplitudes) -> Plane:
    return Plane.over(CONDITIONS, {"natural_period": [4.0], "amplitude": amplitudes})


def test_a_boundary_stands_between_the_rows_of_the_map() -> None:
    amplitudes = [0.1, 1.0, 10.0]
    values = np.array([0.1, np.sqrt(0.1), 1.0, 10.0, 0.0, np.inf, 1e-3, np.nan])
    placed = plane(amplitudes).height_of(values)
    np.testing.assert_allclose(placed[:7], [0, 0.5, 1, 2, -0.5, 2.5, -0.5])
    assert np.isnan(placed[7])


def test_a_linear_condition_places_a_boundary_linearly() -> None:
    linear = Plane.over((SOIL, DEPTH), {"soil": ["sand"], "depth": [10.0, 20.0, 40.0]})
    placed = linear.height_of(np.array([10.0, 15.0, 30.0, 90.0]))
    np.testing.assert_allclose(placed, [0.0, 0.5, 1.5, 2.5])


def test_the_plane_of_a_table_has_numbers_by_size_and_texts_as_they_come() -> None:
    table = pd.DataFrame({"soil": ["sand", "clay", "sand"], "depth": [20.0, 10.0, 10.0]})
    made = Plane.of(table, (SOIL, DEPTH))
    assert (made.columns, made.lines, made.size) == (["sand", "clay"], [10.0, 20.0], 4)
    assert made.place({"soil": "clay", "depth": 20.0}) == (1, 1)


def test_one_condition_makes_a_map_of_one_line() -> None:
    made = Plane.over((DEPTH,), {"depth": [10.0, 20.0]})
    assert made.upwards is None
    assert made.size == 2
    assert made.place({"depth": 20.0}) == (1, 0)


def test_of_three_conditions_one_must_have_a_single_value() -> None:
    grid = {"soil": ["sand", "clay"], "depth": [10.0], "noise": [1.0, 2.0]}
    made = Plane.over((SOIL, DEPTH, NOISE), grid)
    assert (made.across, made.upwards) == (SOIL, NOISE)
    single = Plane.over((SOIL, DEPTH, NOISE), grid | {"soil": ["sand"]})
    assert (single.across, single.upwards) == (SOIL, NOISE)
    with pytest.raises(InputError, match=r"^map: soil, depth, noise all have several values"):
        Plane.over((SOIL, DEPTH, NOISE), grid | {"depth": [1.0, 2.0]})
