"""The one writer of Markdown tables."""

from __future__ import annotations

from owtsweep.io.markdown import escape, table


def test_a_table_has_a_line_per_row_and_sets_numbers_to_the_right():
    text = table(["scheme", "mse"], [["MKF", "1.2"], ["HME1", "0.9"]], numbers=["mse"])
    assert text == "| scheme | mse |\n| --- | ---: |\n| MKF | 1.2 |\n| HME1 | 0.9 |"


def test_a_bar_inside_a_cell_does_not_end_it():
    assert table(["|a|"], [["b|c"]]).splitlines()[::2] == ["| \\|a\\| |", "| b\\|c |"]


def test_names_make_no_html_no_link_no_picture_and_no_second_line():
    hostile = "<script>x</script> ![a](http://b)\n\n# c </b> <!-- -->"
    text = "&lt;script>x&lt;/script> ![a]\\(http://b) # c &lt;/b> &lt;!-- -->"
    assert escape(hostile) == text
    assert table([hostile], []).splitlines()[0] == f"| {text} |"
    assert escape("1 < 2 [3, 4] -> a_b") == "1 < 2 [3, 4] -> a_b"
