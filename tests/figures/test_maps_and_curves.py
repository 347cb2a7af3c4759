"""Maps, the terminal and curves over conditions that are not the hub's."""

from __future__ import annotations

import io
from itertools import combinations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from rich.console import Console
from soil_study import FACTOR, GRID, NOISE, SCHEMES, SOIL, make_rows

from owtsweep.errors import InputError
from owtsweep.figures import best_scheme_map, curves, style, terminal
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import Condition
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise


def make_tables(conditions):
    cube = Cube.of_rows(make_rows(conditions), SCHEMES, conditions, GRID)
    return summarise(cube), find_best_schemes(cube, "full", ["strain"])


def draw_map(best, conditions):
    return best_scheme_map.draw(
        best, SCHEMES, conditions, criterion="strain", window="full", tuning="paper",
        quantity="strain MSE",
    )  # fmt: skip


def labels_of(figure) -> tuple[list[str], list[str], str, str, str]:
    axes = figure.axes[0]
    ticks = [
        [t.get_text() for t in ticks] for ticks in (axes.get_xticklabels(), axes.get_yticklabels())
    ]
    return *ticks, axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")


def test_a_map_over_any_two_conditions():
    conditions = (SOIL, NOISE)
    _, best = make_tables(conditions)
    columns, lines, across, upwards, title = labels_of(draw_map(best, conditions))
    assert (columns, lines) == (["sand", "clay", "rock"], ["1", "5"])
    assert (across, upwards) == ("soil", "sensor noise (%)")
    assert title.startswith("Best scheme by strain MSE\n")
    assert "tuning: paper" in title


def test_a_map_over_one_condition_has_one_line_and_over_three_is_refused():
    _, best = make_tables((NOISE,))
    columns, lines, across, upwards, _ = labels_of(draw_map(best, (NOISE,)))
    assert (columns, lines, across, upwards) == (["1", "5"], [""], "sensor noise (%)", "")
    three = (SOIL, FACTOR, NOISE)
    _, best = make_tables(three)
    with pytest.raises(InputError, match=r"^map: soil, soil_factor, noise all have several values"):
        draw_map(best, three)
    columns, lines, *_ = labels_of(draw_map(best[best["soil_factor"] == 1.0], three))
    assert (columns, lines) == (["sand", "clay", "rock"], ["1", "5"])


@pytest.mark.parametrize("lines", [1, 2])
def test_a_map_of_few_cells_has_room_for_its_names(lines):
    """Whatever stands above and below it: here an origin of four lines, and a long footnote."""
    noise = Condition("noise", "bias of accelerometers over standard deviation")
    best = make_tables((SOIL, NOISE))[1]
    best = best[(best["soil"] != "rock") & best["noise"].isin(GRID["noise"][:lines])]
    with style.context():
        figure = best_scheme_map.draw(
            best, SCHEMES, (SOIL, noise), criterion="strain", window="full", tuning="paper",
            quantity="strain MSE",
            notes=["In summary.csv, but not in the contest, because estimates wait: ALL."] * 5,
        )  # fmt: skip
        style.add_origin(figure, "Truth: one\nof four\nlong\nlines.")
        FigureCanvasAgg(figure).draw()
    axes = figure.axes[0]
    assert axes.get_window_extent().height / figure.dpi >= 0.55 * lines
    boxes = [text.get_window_extent() for text in axes.texts]
    assert len(boxes) == 6 * lines
    boxes += [axes.yaxis.label.get_window_extent(), axes.xaxis.label.get_window_extent()]
    boxes += [figure._supxlabel.get_window_extent(), figure.legends[0].get_window_extent()]
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)


def rendered(best, conditions) -> list[str]:
    console = Console(width=80, file=io.StringIO(), color_system=None)
    console.print(terminal.grid(best, SCHEMES, conditions, "strain", "full"))
    return console.file.getvalue().splitlines()


def test_the_terminal_shows_any_number_of_conditions():
    _, best = make_tables((NOISE,))
    lines = rendered(best, (NOISE,))
    assert any("1 %" in line and "5 %" in line for line in lines)
    assert sum("DKF" in line or "GDF" in line for line in lines[:-1]) == 1
    three = (SOIL, FACTOR, NOISE)
    _, best = make_tables(three)
    lines = rendered(best, three)
    assert [line.strip() for line in lines if line.startswith("noise")] == [
        "noise 1 %",
        "noise 5 %",
    ]
    assert sum(line.split()[:3] == ["sand", "clay", "rock"] for line in lines) == 0
    assert sum("sand" in line and "rock" in line for line in lines) == 2
    assert any(line.startswith("cells: ") for line in lines)


@pytest.mark.parametrize("along", [SOIL, FACTOR, NOISE])
def test_curves_over_texts_and_over_linear_and_logarithmic_numbers(along):
    three = (SOIL, FACTOR, NOISE)
    table, _ = make_tables(three)
    fixed = {c: GRID[c.name][0] for c in three if c != along}
    shown = curves.choose(table, SCHEMES, "full", fixed)
    assert len(shown) == len(SCHEMES) * len(GRID[along.name]) * 2
    panels = {"strain": "strain MSE", "force": "force MSE"}
    figure = curves.draw(shown, SCHEMES, along, panels, title="Errors")
    figure.canvas.draw()
    for axes in figure.axes:
        assert axes.get_xlabel() == along.title
        assert axes.get_xscale() == ("log" if along.scale == "log" else "linear")
        assert len(axes.get_lines()) == len(SCHEMES)
    if along == SOIL:
        ticks = [text.get_text() for text in figure.axes[0].get_xticklabels()]
        assert ticks == ["sand", "clay", "rock"]


def test_curves_where_nothing_was_run_name_what_there_is():
    table, _ = make_tables((SOIL, NOISE))
    with pytest.raises(
        InputError, match=r"^noise: no result at 3 % in window 'full'; this run has 1, 5$"
    ):
        curves.choose(table, SCHEMES, "full", {NOISE: 3.0})
