"""Draws the map of best schemes as SVG, which stands on a page without JavaScript too.

The scripts of the page fill the same cells with other numbers; they draw no map of their own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from owtsweep.figures.margin import fill_cell, ratio_of
from owtsweep.figures.palette import style_of, text_color_on
from owtsweep.figures.plane import Plane, Row
from owtsweep.report.document import clean
from owtsweep.results.conditions import Condition, Grid, Value, select, show_value
from owtsweep.results.contents import Contents
from owtsweep.results.criteria import show_error

#: Least width and height of a cell with text, width and height of one without, the rooms left of
#: the map and below it, and the distance of lines, in pixels.
CELL, SMALL_CELL = (92, 43), (16, 16)
BESIDE, BELOW, LINE = 76, 44, 12
#: A map with more columns or lines than this has small cells without text.
MOST_COLUMNS, MOST_LINES = 14, 24
#: Most letters of a name in a cell, their width in pixels, that of the next best's, and letters of
#: a ratio; most letters beside the map.
MOST_LETTERS, LETTER, SMALL_LETTER, RATIO, MOST_LABEL = 16, 8.4, 6.8, 6, 10


def choose_axes(conditions: Sequence[Condition], grid: Grid) -> Plane:
    """Return the axes of a map: of conditions with more than one value, the first two."""
    varied = [condition.name for condition in conditions if len(grid[condition.name]) > 1]
    return Plane.over(conditions, {**grid, **{name: grid[name][:1] for name in varied[2:]}})


def get_grid(contents: Contents) -> dict[str, list[Value]]:
    """Return condition -> its values."""
    return dict(zip(contents.cube.names, contents.cube.levels, strict=True))


def draw(contents: Contents) -> str:
    """Return the map by the first criterion as an SVG element.

    Of more than two conditions with several values, the map has the first value of the others.
    """
    grid, best = get_grid(contents), contents.cells
    plane = choose_axes(contents.conditions, grid)
    columns, lines = plane.columns, plane.lines
    criterion = next(iter(contents.criteria))
    shown = best[(best["criterion"] == criterion) & (best["window"] == contents.window)]
    shown = select(shown, {name: grid[name][0] for name in plane.list_off(contents.conditions)})
    rows = {plane.place(row): row for row in shown.to_dict("records")}
    labelled = len(columns) <= MOST_COLUMNS and len(lines) <= MOST_LINES
    letters = [max(map(len, best[name]), default=0) for name in ("best", "runner_up")]
    first, second = (min(count, MOST_LETTERS) for count in letters)
    wide = round(max(LETTER * first, SMALL_LETTER * (second + RATIO))) + 10
    size = (max(CELL[0], wide), CELL[1]) if labelled else SMALL_CELL
    width, height = size
    right, bottom = BESIDE + width * len(columns), height * len(lines)
    parts = []
    for i, column in enumerate(columns):
        for j, line in enumerate(lines):
            x, y = BESIDE + width * i, bottom - height * (j + 1)
            row, where = rows.get((i, j)), _name_cell(plane, column, line)
            parts.append(_draw_cell(row, contents.cube.schemes, (i, j), (x, y, *size), where))
    every = 1 if labelled else -(-len(columns) // 8)
    for i in range(0, len(columns), every):
        x = BESIDE + width * i + width // 2
        parts.append(_write(x, bottom + 16, "middle", _shorten(columns[i])))
    parts.append(_write(BESIDE, bottom + 34, "start", plane.across.title, "axis"))
    every = 1 if labelled else -(-len(lines) // 12)
    for j in range(0, len(lines), every):
        if plane.upwards:
            y = bottom - height * j - height // 2 + 4
            parts.append(_write(BESIDE - 6, y, "end", _shorten(lines[j])))
    if plane.upwards:
        parts.append(_write(0, -8, "start", plane.upwards.title, "axis"))
    top, side = 22, max(right, 340)
    name = f"Best scheme by {contents.criteria[criterion].title}"
    return (
        f'<svg class="map" viewBox="0 {-top} {side + 4} {bottom + BELOW + top}" '
        f'width="{side + 4}" height="{bottom + BELOW + top}" role="group" '
        f'aria-label="{clean(name)}">'
        '<defs><pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse" '
        'patternTransform="rotate(45)"><path d="M0 0V6" stroke="#000000" stroke-opacity=".4" '
        'stroke-width="1.5"/></pattern></defs>' + "".join(parts) + "</svg>"
    )


def _draw_cell(
    row: Row | None,
    schemes: Sequence[str],
    number: tuple[int, int],
    box: tuple[int, int, int, int],
    where: str,
) -> str:
    (i, j), (x, y, width, height) = number, box
    fill = "#d9d9d9"
    texts, told = ["", "", ""], "no result"
    if row is not None:
        fill = fill_cell(style_of(row["best"], schemes), ratio_of(row))
        texts = list_texts(row)
        told = f"{row['best']}, {row['verdict']}"
    inside = f'x="{x}" y="{y}" width="{width - 2}" height="{height - 2}"'
    is_open = row is not None and row["verdict"] == "open"
    parts = [
        f'<rect {inside} fill="{fill}"/>',
        f'<rect class="mark" {inside} fill="{"url(#hatch)" if is_open else "none"}"/>',
    ]
    if (width, height) != SMALL_CELL:
        color, middle = text_color_on(fill), x + width // 2 - 1
        parts += [
            f'<text class="{name}" x="{middle}" y="{y + LINE * n}" text-anchor="middle" '
            f'fill="{color}">{clean(text)}</text>'
            for n, (name, text) in enumerate(
                zip(("best", "error", "next"), texts, strict=True), start=1
            )
        ]
    return (
        f'<g class="cell" id="c{i}-{j}"><title>{clean(where)}: {clean(told)}</title>'
        + "".join(parts)
        + "</g>"
    )


def list_texts(row: Row) -> list[str]:
    """Return the three lines of a cell: the best scheme, its error, and the next best one."""
    mark = " =" if row["verdict"] == "tie" else ""
    texts = [_shorten(row["best"], MOST_LETTERS) + mark, show_error(row["error_best"]), ""]
    ratio = ratio_of(row)
    if row["runner_up"] and ratio == ratio:
        texts[2] = f"{_shorten(row['runner_up'], MOST_LETTERS)} ×{ratio:.3g}"
    return texts


def _name_cell(plane: Plane, column: Value, line: Value) -> str:
    named = [f"{plane.across.word} {plane.across.show(column)}"]
    if plane.upwards:
        named.append(f"{plane.upwards.word} {plane.upwards.show(line)}")
    return ", ".join(named)


def _write(x: int, y: int, anchor: str, text: str, kind: str = "tick") -> str:
    return f'<text class="{kind}" x="{x}" y="{y}" text-anchor="{anchor}">{clean(text)}</text>'


def _shorten(value: Value, most: int = MOST_LABEL) -> str:
    text = show_value(value)
    return text if len(text) <= most else f"{text[: most - 1]}…"


def list_legend(contents: Contents) -> Mapping[str, str]:
    """Return scheme -> its colour, of those that are best in some cell by the first criterion."""
    cells = contents.cells
    winners = set(cells.loc[cells["criterion"] == next(iter(contents.criteria)), "best"])
    names = [name for name in contents.cube.schemes if name in winners]
    return {name: style_of(name, contents.cube.schemes).color for name in names}
