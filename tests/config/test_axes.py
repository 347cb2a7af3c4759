"""Entries of an axis become numbers; what cannot be an entry is one line."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from owtsweep.config import Axis, Positive, Section, key, typed
from owtsweep.config import grid as grid_module
from owtsweep.config.grid import expand
from owtsweep.errors import InputError


class Grid(Section):
    """An axis of numbers and one of whole numbers."""

    noise: Axis[Positive] = key("an axis", unit="m", default=[1.0])
    count: Axis[int] = key("whole numbers", default=[1])


@pytest.mark.parametrize(
    ("entries", "numbers"),
    [
        ([{"log": [0.1, 10, 3]}], [0.1, 1.0, 10.0]),
        ([{"linear": [0.1, 0.5, 5]}], [0.1, 0.2, 0.3, 0.4, 0.5]),
        ([0.05, {"log": [1, 100, 3]}, 200], [0.05, 1.0, 10.0, 100.0, 200.0]),
        ([{"linear": [1, 2, 2]}, {"linear": [3, 4, 2]}], [1.0, 2.0, 3.0, 4.0]),
    ],
)
def test_entries_become_numbers(entries: list[object], numbers: list[float]) -> None:
    assert typed(Grid, {"noise": entries}).noise == numbers


def test_an_axis_of_whole_numbers_takes_entries_that_give_such() -> None:
    assert typed(Grid, {"count": [{"linear": [1, 9, 5]}]}).count == [1, 3, 5, 7, 9]
    with pytest.raises(InputError, match=r"^count\[1\]: 1\.5 is not a whole number"):
        typed(Grid, {"count": [{"linear": [1, 2, 3]}]})


@given(st.floats(1e-6, 1e6), st.floats(1.001, 1e6), st.integers(2, 40))
def test_the_ends_are_exact_and_the_numbers_rise_evenly(
    first: float, factor: float, count: int
) -> None:
    last = first * factor
    for spacing, even in (("log", math.log), ("linear", float)):
        numbers = expand([{spacing: [first, last, count]}])
        assert (len(numbers), numbers[0], numbers[-1]) == (count, first, last)
        steps = [even(b) - even(a) for a, b in pairwise(numbers)]
        assert min(steps) == pytest.approx(max(steps), rel=1e-4)


@pytest.mark.parametrize(
    ("entries", "says"),
    [
        ([{"log": [10, 0.05, 3]}], r"{log: \[10, 0.05, 3\]} does not rise; give the lower end"),
        ([{"linear": [1, 1, 3]}], r"does not rise"),
        ([{"log": [True, 10, 3]}], r"is no entry of an axis"),
        ([{"log": [0.05, 10, 1]}], r"has a count of 1; give 2 to 1000000"),
        ([{"log": [0.05, 10, 10**9]}], r"give 2 to 1000000"),
        ([{"log": [0, 10, 3]}], r"must begin above zero; use linear"),
        ([{"log": [1, math.inf, 3]}], r"needs finite ends"),
        ([{"log": [1, 10, 2.5]}], r"is no entry of an axis; use a number, {log: \[first, last"),
        ([{"log": [1, 10]}], r"is no entry of an axis"),
        ([{"log": [1, "x", 3]}], r"is no entry of an axis"),
        ([{"lin": [1, 10, 3]}], r"is no entry of an axis"),
        ([{"log": [1, 10, 3], "linear": [1, 2, 3]}], r"is no entry of an axis"),
        ([1.0, {"linear": [1, 2, 3]}], r"a value stands there twice"),
        ([], r"the list is empty; give at least one value, in m"),
        (3, r"3 is no list; use e.g. noise=\[3\]"),
    ],
)
def test_what_is_no_axis_is_one_line(entries: object, says: str) -> None:
    with pytest.raises(InputError, match=f"^noise: .*{says}") as caught:
        typed(Grid, {"noise": entries})
    assert "\n" not in str(caught.value)


def test_an_axis_that_the_study_does_not_have_is_one_line() -> None:
    with pytest.raises(InputError, match=r"^wind: there is no such key"):
        typed(Grid, {"wind": [{"log": [1, 2, 3]}]})


def test_ranges_together_have_a_bound(monkeypatch) -> None:
    monkeypatch.setattr(grid_module, "MOST_POINTS", 100)
    with pytest.raises(ValueError, match="more than 100 values"):
        expand([{"log": [1, 2, 99]}, {"log": [3, 4, 9]}])
