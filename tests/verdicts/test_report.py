"""One document in two renderings, and the files of a report."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from owtsweep.figures import style
from owtsweep.verdicts.page import Bullets, Heading, Paragraph, Picture, TextTable
from owtsweep.verdicts.report import write_report
from owtsweep.verdicts.sections import (
    consistency_section,
    count_verdicts,
    format_ratio,
    missing_section,
)
from owtsweep.verdicts.summary import Item, distance_rows, make_table


def contents(pictures):
    return [
        Heading("A run & a paper", 1),
        Paragraph("It <agrees>."),
        Bullets(["one", "two"]),
        TextTable(["item", "value"], [["a|b", "1.5"], ["verdict", "reproduced"]], ["value"]),
        Picture(pictures["empty"], "Nothing."),
    ]


def test_a_report_writes_tables_figures_and_both_pages(tmp_path):
    files = write_report(
        tmp_path / "judged",
        title="A title",
        tables={"numbers": pd.DataFrame({"value": [0.1]})},
        figures={"empty": lambda: style.new_figure(2.0, 1.0)},
        contents=contents,
        metadata={"run": "3f2a"},
    )
    names = [path.relative_to(tmp_path / "judged").as_posix() for path in files]
    assert names == [
        "numbers.csv", "figures/empty.png", "figures/empty.svg", "fidelity.md",
        "fidelity.html",
    ]  # fmt: skip
    markdown = files[3].read_text(encoding="utf-8")
    assert markdown.startswith("# A run & a paper\n\nIt &lt;agrees>.\n\n- one\n- two\n\n")
    assert "| item | value |\n| --- | ---: |\n| a\\|b | 1.5 |" in markdown
    assert markdown.endswith("![Nothing.](figures/empty.png)\n")
    html = files[4].read_text(encoding="utf-8")
    assert "<h1>A run &amp; a paper</h1>" in html
    assert '<td class="number good">reproduced</td>' in html
    assert 'src="data:image/png;base64,' in html


def test_a_summary_has_a_row_per_item_and_their_ratio():
    numbers = pd.DataFrame({"scheme": ["A", "A", "B"], "log2": [0.2, -0.4, float("nan")]})
    rows = [
        Item("item", "number", 2.0, 3.0, agrees="yes"),
        *distance_rows(numbers, {("A",): 0.35}),
    ]
    table = make_table(rows).set_index("item")
    assert table.loc["item", "ratio"] == 1.5
    median = table.loc["median |log2 ratio|, A"]
    assert (round(median["reproduced"], 12), median["agrees"]) == (0.3, "yes")
    assert median["why"] == "over 2 of 2 numbers, a factor of 1.23; agreement: at most 0.35"
    incomplete = next(iter(distance_rows(numbers, {("A", "B"): 0.35})))
    assert incomplete.agrees == "missing"


def test_an_infinite_distance_leaves_blanks_and_does_not_agree():
    """A perfect scheme has it; warnings are errors in tests."""
    numbers = pd.DataFrame({"scheme": ["A"] * 3, "log2": [-float("inf")] * 2 + [0.1]})
    median, percentile = distance_rows(numbers, {("A",): 0.35})
    assert not np.isfinite([median.reproduced, percentile.reproduced]).any()
    assert (median.agrees, percentile.agrees) == ("no", "")
    assert median.why == "over 3 of 3 numbers; agreement: at most 0.35"
    far = pd.DataFrame({"scheme": ["A"], "log2": [-1053.0]})
    assert "a factor of inf" in next(iter(distance_rows(far, {("A",): 0.35}))).why


def test_sections_without_anything_to_tell_are_left_out():
    complete = pd.DataFrame({"table": [1], "scheme": ["A"], "reproduced": [1.0]})
    assert missing_section(complete, []) == []
    lacking = complete.assign(reproduced=float("nan"))
    assert missing_section(lacking, [])[-1] == Bullets(["Published numbers: Table 1 A."])
    assert count_verdicts([]) == ""


def test_consistency_is_told_per_scheme():
    table = pd.DataFrame(
        {
            "scheme": ["A", "A"],
            "nees": [0.9, 1.2],
            "nis": [float("nan")] * 2,
            "verdict": ["mixed"] * 2,
        }
    )
    *_, text, grid = consistency_section(table, ["A"], {"nees": 4.0, "nis": 2.0})
    assert text.text.startswith("Mean NEES over 4 and mean NIS over 2 in each cell")
    assert grid.rows == [["A", "0.9 to 1.2", "–", "mixed 2"]]


@pytest.mark.parametrize(
    ("ratio", "text"), [(0.0042, "0.0042"), (0.1, "0.10"), (1.0, "1.00"), (354.749, "354.75")]
)
def test_no_ratio_is_shown_as_zero(ratio, text):
    assert format_ratio(ratio) == text
