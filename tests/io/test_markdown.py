"""The one writer of Markdown tables."""

from __future__ import annotations

from owtsweep.io.markdown import table


def test_a_table_has_a_line_per_row_and_sets_numbers_to_the_right():
    text = table(["scheme", "mse"], [["MKF", "1.2"], ["HME1", "0.9"]], numbers=["mse"])
    assert text == "| scheme | mse |\n| --- | ---: |\n| MKF | 1.2 |\n| HME1 | 0.9 |"


def test_a_bar_inside_a_cell_does_not_end_it():
    assert table(["|a|"], [["b|c"]]).splitlines()[::2] == ["| \\|a\\| |", "| b\\|c |"]
