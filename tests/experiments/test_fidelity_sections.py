"""Sections and summary of the report on Ren et al. (2019), and a number beside records."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from experiments.ren2019.numbers import COLUMNS, compare_number, lies_within_records
from experiments.ren2019.sections import consistency_section, format_ratio, missing_section
from experiments.ren2019.summaries import Item, distance_rows, make_table
from owtsweep.verdicts.inference import MISSING
from owtsweep.verdicts.page import Bullets


def test_a_summary_has_a_row_per_item_and_their_ratio():
    numbers = pd.DataFrame({"scheme": ["A", "A", "B"], "log2": [0.2, -0.4, float("nan")]})
    rows = [
        Item("item", "number", 2.0, 3.0, agrees="yes"),
        *distance_rows(numbers, [("A",)]),
    ]
    table = make_table(rows).set_index("item")
    assert table.loc["item", "ratio"] == 1.5
    median = table.loc["median |log2 ratio|, A"]
    assert (round(median["reproduced"], 12), median["agrees"]) == (0.3, "")
    assert median["why"] == "over 2 of 2 numbers, a factor of 1.23"
    incomplete = next(iter(distance_rows(numbers, [("A", "B")])))
    assert incomplete.why.startswith("over 2 of 3 numbers")


def test_an_infinite_distance_leaves_blanks():
    """A perfect scheme has it; warnings are errors in tests."""
    numbers = pd.DataFrame({"scheme": ["A"] * 3, "log2": [-float("inf")] * 2 + [0.1]})
    median, percentile = distance_rows(numbers, [("A",)])
    assert not np.isfinite([median.reproduced, percentile.reproduced]).any()
    assert (median.agrees, percentile.agrees) == ("", "")
    assert median.why == "over 3 of 3 numbers"
    far = pd.DataFrame({"scheme": ["A"], "log2": [-1053.0]})
    assert "a factor of inf" in next(iter(distance_rows(far, [("A",)]))).why


def test_sections_without_anything_to_tell_are_left_out():
    complete = pd.DataFrame({"table": [1], "scheme": ["A"], "reproduced": [1.0]})
    assert missing_section(complete, []) == []
    lacking = complete.assign(reproduced=float("nan"))
    assert missing_section(lacking, [])[-1] == Bullets(["Published numbers: Table 1 A."])


def test_consistency_is_told_per_scheme():
    table = pd.DataFrame(
        {
            "scheme": ["A", "A"],
            "nees": [0.9, 1.2],
            "nis": [float("nan")] * 2,
            "verdict": ["mixed"] * 2,
        }
    )
    *_, text, grid = consistency_section(table, ["A"])
    assert text.text.startswith("Mean NEES over 4 and mean NIS over 2 in each cell")
    assert grid.rows == [["A", "0.9 to 1.2", "–", "mixed 2"]]


@pytest.mark.parametrize(
    ("ratio", "text"), [(0.0042, "0.0042"), (0.1, "0.10"), (1.0, "1.00"), (354.749, "354.75")]
)
def test_no_ratio_is_shown_as_zero(ratio, text):
    assert format_ratio(ratio) == text


def test_a_published_number_has_its_place_among_the_records():
    records = np.arange(1.0, 102.0)
    compared = compare_number(records, 51.0)
    assert list(compared) == list(COLUMNS)
    assert compared["reproduced"] == compared["ratio"] * 51.0 == 51.0
    assert compared["record_low"] < 51.0 < compared["record_high"]
    assert 0.5 < compared["chance"] < 1.0
    assert not compared["missed_by_factor_2"]
    assert compare_number(records, 25.0)["missed_by_factor_2"]
    for published, agrees in ((51.0, "yes"), (1000.0, "no")):
        row = SimpleNamespace(published=published, **compare_number(records, published))
        assert lies_within_records(row) == agrees
    nothing = SimpleNamespace(published=1.0, **compare_number(None, 1.0))
    assert lies_within_records(nothing) == MISSING
    assert nothing.missed_by_factor_2 is False
