"""A table in the terminal is read whole, however narrow the terminal is."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from owtsweep.io.terminal import PartedTable

HEADINGS = ["sensors.gnss.delay", "tuning", "cells EKF", "cells HME1", "boundary", "cells changed"]
ROWS = [
    ["0.1", "paper", "0", "14", "0.15-0.63 m at 4/4 periods", "-"],
    ["0.2", "[matched]", "12", "4", "none (HME1 better)", "12 (0 established)"],
]


def print_at(width: int) -> list[str]:
    console = Console(width=width, file=io.StringIO(), color_system=None)
    console.print(PartedTable(HEADINGS, ROWS, repeated=2, title="a title", caption="A caption."))
    return console.file.getvalue().splitlines()


@pytest.mark.parametrize(("width", "parts"), [(200, 1), (80, 2), (60, 3)])
def test_no_text_is_cut(width: int, parts: int) -> None:
    lines = print_at(width)
    assert lines[0] == "a title"
    assert lines[-1] == "A caption."
    assert max(map(len, lines)) <= width
    assert sum("sensors.gnss.delay  tuning" in line for line in lines) == parts
    for row in ROWS:
        mine = [line for line in lines if line.startswith(row[0])]
        assert len(mine) == parts
        assert all(row[1] in line.split() for line in mine)
        assert all(any(cell in line for line in mine) for cell in row)
    for heading in HEADINGS:
        assert all(any(word in line.split() for line in lines) for word in heading.split())


def test_a_column_wider_than_the_terminal_is_folded() -> None:
    text = "".join("".join(line.split()) for line in print_at(30))
    assert "0.15-0.63mat" in text
    assert "boundary" in text
