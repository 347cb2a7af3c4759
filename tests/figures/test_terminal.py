"""The map in the terminal is read in narrow terminals, with few colours and with none."""

from __future__ import annotations

import io
import itertools
import re

import pandas as pd
import pytest
from looks import LOOKS
from rich.cells import cell_len
from rich.color import Color, ColorSystem
from rich.console import Console
from rich.measure import Measurement

from owtsweep.figures import terminal
from owtsweep.figures.palette import relative_luminance, style_of, text_color_on
from owtsweep.results.conditions import Condition

PERIODS, AMPLITUDES = [3.0, 4.0, 5.0, 6.0, 7.0, 8.0], [0.05, 0.7, 10.0]
CONDITIONS = (
    Condition("natural_period", "natural period", "s"),
    Condition("amplitude", "amplitude", "m", scale="log"),
)
SCHEMES = ["EKF", "MKF", "HME1", "HME2"]
LONG = [f"{name}_with_a_name_of_sixty_letters".ljust(60, "x") for name in SCHEMES]


def make_best(schemes=SCHEMES, conditions=CONDITIONS, grid=(PERIODS, AMPLITUDES)) -> pd.DataFrame:
    """Every scheme wins some cells; every third cell is open, and one is tied."""
    names = [condition.name for condition in conditions]
    rows = []
    for number, cell in enumerate(itertools.product(*grid)):
        row = dict(zip(names, cell, strict=True)) | {"criterion": "position", "window": "full"}
        row |= {"best": schemes[number % 4]}
        row |= {"verdict": "open" if number % 3 == 0 else "tie" if number == 1 else "won"}
        error = 0.01234 * (1 + number)
        rows.append(row | {"error_best": error, "error_runner_up": error * (1.0 + number / 8.0)})
    return pd.DataFrame(rows)


def show(best, schemes=SCHEMES, *, conditions=CONDITIONS, **console) -> str:
    to = Console(file=io.StringIO(), **console)
    to.print(terminal.grid(best, schemes, conditions, "position", "full"))
    return to.file.getvalue()


def test_sixty_columns_hold_the_map_of_the_paper():
    lines = show(make_best(), width=60, color_system=None).splitlines()
    assert max(map(len, lines)) <= 60
    assert sum("3 s" in line and "8 s" in line for line in lines) == 1
    (highest,) = [line for line in lines if line.strip().startswith("10 m")]
    assert highest.split() == ["10", "m", "HME1", "MKF", "EKF", "HME2", "HME1", "MKF"]
    told = " ".join(" ".join(lines).split())
    assert "= tie: the simplest of several" in told
    assert "~ open: the data do not tell" in told
    below = lines[lines.index(highest) + 1]
    assert below.split() == ["0.0370", "0.0740", "0.111", "0.148", "0.185", "0.222"]


@pytest.mark.parametrize("width", [16, 24, 40, 60, 80, 200])
@pytest.mark.parametrize("schemes", [SCHEMES, LONG])
def test_nothing_is_cut_at_any_width(width, schemes):
    best = make_best(schemes).iloc[1:]
    text = show(best, schemes, width=width, color_system=None)
    assert max(map(cell_len, text.splitlines())) <= width
    assert "\N{HORIZONTAL ELLIPSIS}" not in text
    whole = "".join(text.split())
    signs = dict(zip(schemes, schemes if schemes is SCHEMES else "ABCD", strict=True))
    for name, sign in signs.items():
        count = int((best["best"] == name).sum())
        told = f"{name}{count}" if sign == name else f"{sign}={name}{count}"
        assert told in whole
    body = text.split("cells:")[0]
    for sign in signs.values():
        assert len(re.findall(rf" {sign} ", body)) == list(best["best"].map(signs)).count(sign)
    for verdict in ("open", "tie"):
        count = body.count(terminal.MARKS[verdict])
        assert count == (best["verdict"] == verdict).sum()
    assert "-noresult" in whole


def test_a_long_name_leaves_the_short_ones():
    schemes = ["A", "MKF", "my_scheme_of_the_last_fix", "HME2"]
    text = show(make_best(schemes), schemes, width=80, color_system=None)
    body, legend = text.split("cells:")
    assert set(re.findall(r"[A-Z]\w*", body.split("\n", 2)[2])) == {"A", "MKF", "B", "HME2"}
    assert "B = my_scheme_of_the_last_fix 4" in legend


def test_a_name_of_two_words_has_two_lines_in_its_cells():
    schemes = ["AKF", "AKF_MATERN32", "MEKF_HEADING", "KF_CONSISTENT"]
    text = show(make_best(schemes), schemes, width=80, color_system=None)
    body, legend = text.split("cells:")
    for words in (["AKF_", "MATERN32"], ["MEKF_", "HEADING"], ["KF_", "CONSISTENT"]):
        counts = {len(re.findall(rf" {word} ", body)) for word in words}
        assert counts == {int(re.findall(rf"{''.join(words)} (\d+)", legend)[0])}


def test_the_axes_are_named():
    text = show(make_best(), width=80, color_system=None)
    across, upwards = (condition.label for condition in CONDITIONS[:2])
    assert f"Across: {across}; upwards: {upwards}\n" in text


def test_a_long_name_that_wins_nowhere_widens_no_cell():
    same = show(make_best(), width=80, color_system=None)
    assert show(make_best(), [*SCHEMES, LONG[0]], width=80, color_system=None) == same


@pytest.mark.parametrize("across", [True, False])
def test_long_categories_are_folded(across):
    kinds, periods = ["very dense sand over stiff clay", "rock", "silt"], [3.0, 4.0]
    conditions, grid = (CONDITIONS[0], Condition("soil", "soil")), (periods, kinds)
    if across:
        conditions, grid = conditions[::-1], grid[::-1]
    best = make_best(conditions=conditions, grid=grid)
    text = show(best, conditions=conditions, width=26, color_system=None)
    assert "\N{HORIZONTAL ELLIPSIS}" not in text
    assert max(map(cell_len, text.splitlines())) <= 26
    assert all(word in text for word in ["very", "dense", "sand", "over", "stiff", "clay"])


def test_colours_are_used_where_they_can_be_relied_on():
    best = make_best()
    plain = show(best, width=80, color_system=None)
    few = show(best, width=80, color_system="standard", force_terminal=True)
    assert re.sub(r"\x1b\[1m|\x1b\[0m", "", few) == plain  # bold heading, no colour
    none = show(best, width=80, color_system="truecolor", force_terminal=True, no_color=True)
    assert re.sub(r"\x1b\[1m|\x1b\[0m", "", none) == plain
    many = show(best, width=80, color_system="256", force_terminal=True)
    assert len(set(re.findall(r"48;5;(\d+)m", many))) == len(SCHEMES)  # full colours
    all_of_them = show(best, width=80, color_system="truecolor", force_terminal=True)
    assert len(set(re.findall(r"48;2;(\d+;\d+;\d+)m", all_of_them))) > 2 * len(SCHEMES)  # shades
    assert "Pale: " in all_of_them
    assert "Pale: " not in many + few + none


def test_text_is_readable_on_the_256_colours():
    fills = set()
    for name in LOOKS:  # with the baselines
        look = style_of(name, SCHEMES)
        fill, text = (
            Color.parse(color).downgrade(ColorSystem.EIGHT_BIT).get_truecolor().hex
            for color in (look.color, text_color_on(look.color))
        )
        low, high = sorted(map(relative_luminance, (fill, text)))
        assert (high + 0.05) / (low + 0.05) >= 4.5, name
        fills.add(fill)
    assert len(fills) == len(LOOKS)


def test_two_maps_side_by_side_know_their_widths():
    console = Console(width=200)
    (table,) = [
        part
        for part in terminal.grid(make_best(), SCHEMES, CONDITIONS, "position", "full").renderables
        if isinstance(part, terminal._Map)
    ]
    measured = Measurement.get(console, console.options, table)
    lines = show(make_best(), width=200, color_system=None).splitlines()
    assert measured.maximum == max(len(line) for line in lines if " m  " in line)
    narrow = show(make_best(), width=measured.minimum, color_system=None).splitlines()
    assert max(len(line) for line in narrow if " m  " in line) == measured.minimum
