"""A page is one safe file: nothing of a run is executed, nothing is asked of a network."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from itertools import product

import numpy as np
import pandas as pd
import pytest
from pages import PERIOD, SQUARE, make_contents, read_data, run_script

from owtsweep.report.document import hide_places, make_document
from owtsweep.report.run_page import Extras, Origin, Shown, make_run_page
from owtsweep.report.static_map import choose_axes, draw
from owtsweep.results.conditions import Condition
from owtsweep.results.contents import Contents
from owtsweep.results.cube import Cube

RECORDS = {"A": 32, "B": 32, "C": 16, "NONE": 8}
ORIGIN = Origin({"seed": "1"}, "owtsweep sweep", "seed: 1\n")
HOSTILE = "</script><script>alert(1)</script>"


def make_page(contents, *, title="run", origin=ORIGIN, extras=None, exact=False):
    shown = {"": Shown(contents)}
    return make_run_page(title, shown, origin, extras or Extras(), exact=exact)


class Reader(HTMLParser):
    """Collects what a page would run or load."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.scripts: list[str] = []
        self.styles: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.open: list[str] = []
        self._kind = ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.attributes += [(tag, name, value or "") for name, value in attributes]
        kind = dict(attributes).get("type", "")
        self._kind = "" if kind == "application/json" else tag

    def handle_data(self, data):
        if self._kind == "script":
            self.scripts.append(data)
        if self._kind == "style":
            self.styles.append(data)

    def handle_endtag(self, tag):
        self._kind = ""


@pytest.mark.parametrize("superposed", [True, False])
def test_a_page_runs_its_own_script_alone_and_loads_nothing(superposed):
    page = make_page(make_contents(RECORDS, superposed=superposed))
    read = Reader(page)
    (policy,) = [v for tag, name, v in read.attributes if "default-src 'none'" in v]
    for texts, source in ((read.scripts, "script-src"), (read.styles, "style-src")):
        (text,) = texts
        digest = base64.b64encode(sha256(text.encode()).digest()).decode()
        assert f"{source} 'sha256-{digest}'" in policy
    assert "base-uri 'none'; form-action 'none'" in policy
    assert not [name for _, name, _ in read.attributes if name.startswith("on") or name == "style"]
    links = [value for _, name, value in read.attributes if name in ("src", "href")]
    assert links == ["data:,"]
    assert "http" not in page.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")


@pytest.mark.parametrize("name", [HOSTILE, "=cmd()", "\u202egnp.exe", "x" * 200, "אבג", "a&b<c>"])
def test_names_of_a_stranger_are_text(name):
    contents = make_contents({name: 8, "B": 8, "NONE": 8})
    extras = Extras({name: pd.DataFrame({name: [name]})}, {name: b"png"}, name)
    origin = Origin({name: name}, name, name)
    contents = replace(contents, answer=[name] * 3, origin=[name])
    page = make_page(contents, title=name, origin=origin, extras=extras)
    assert len(Reader(page).scripts) == 1
    assert HOSTILE not in page
    assert "\u202e" not in page
    data = read_data(page)
    shown = data["parts"][0]["schemes"][0]["name"]
    assert shown == name.replace("\u202e", "\\u202e")
    assert shown in data["parts"][0]["cells"]["best"]
    assert run_script(data, "return judgeCell(part, {criterion: 'position', window: 'settled', "
                      "records: Infinity}, [0, 0]).best") in (shown, "B", "NONE")  # fmt: skip


def test_no_folder_of_a_machine_is_on_a_page():
    text = "owtsweep sweep results=/home/ann/runs structure=C:\\Users\\ann\\tower.yaml ~/x/y.csv"
    hidden = hide_places(text)
    assert hidden == "owtsweep sweep results=…/runs structure=…/tower.yaml …/y.csv"
    assert hide_places("m/s and m/s²/√s, 3/4 of it: docs/better.md") == (
        "m/s and m/s²/√s, 3/4 of it: docs/better.md"
    )
    page = make_page(make_contents(RECORDS), origin=Origin({}, text, f"file: {text}"))
    assert "ann" not in page.replace("channel", "")


def test_without_scripts_the_answer_the_map_and_the_table_stand_there():
    contents = make_contents(RECORDS)
    best = contents.cells
    page = make_page(contents)
    read = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert "Best: A. Error: small." in read
    svg = read[read.index('<svg class="map"') : read.index("</figure>")]
    assert svg.count('<g class="cell"') == 6
    for error in best[best["criterion"] == "position"]["error_best"]:
        assert f"{error:.3f}" in svg
        assert f"<td>{error:.3g}</td>" in read
    assert read.count("<tr>") == 1 + 6


def test_a_map_of_one_cell_one_scheme_one_record():
    contents = make_contents({"A": 1, "NONE": 1})
    cube = contents.cube
    small = Cube(
        ("A",), cube.conditions, ([3.0], [0.5]), cube.measures, cube.windows, (0,),
        cube.products[:, :1, :1], None, cube.unable,
    )  # fmt: skip
    best = pd.DataFrame(
        [{
            "natural_period": 3.0, "amplitude": 0.5, "criterion": "position", "window": "settled",
            "verdict": "open", "best": "A", "runner_up": "", "left": "A", "error_best": 0.2,
            "error_low": np.nan, "error_high": np.nan, "error_runner_up": np.nan, "look": 0,
            "n": 1, "more": 0.0,
        }]
    )  # fmt: skip
    contents = replace(contents, cells=best, cube=small, contenders=["A"], baselines=[])
    page = make_page(contents)
    assert page.count('<g class="cell"') == 1
    code = "return runContest(part, 'position', 'settled', [0, 0], Infinity, null).length"
    assert run_script(read_data(page), code) == 1


def test_ten_thousand_cells_have_means_and_choices_of_further_axes():
    conditions = [Condition(name, name, "m") for name in ("a", "b", "c")]
    levels = {"a": np.arange(50.0), "b": np.arange(20.0), "c": np.arange(10.0)}
    cells = pd.DataFrame(list(product(*levels.values())), columns=list(levels))
    rows = pd.concat(
        cells.assign(
            scheme=name, measure="position", window="settled", replicate=replicate, status="ok",
            reason="", value=0.01 * (1 + replicate) * factor * (1.0 + cells["a"]),
        )
        for name, factor in (("A", 1.0), ("B", 2.0))
        for replicate in range(2)
    )  # fmt: skip
    grid = {name: list(values) for name, values in levels.items()}
    cube = Cube.of_rows(rows, ["A", "B"], conditions, grid)
    error = np.sqrt(0.015 * (1.0 + cells["a"]))
    best = cells.assign(
        criterion="position", window="settled", verdict="won", best="A", runner_up="B", left="A",
        error_best=error, error_low=error, error_high=error, error_runner_up=error * 2**0.5,
        look=0, n=2, more=0.0,
    )  # fmt: skip
    contents = Contents(
        [], ["Best: A."], conditions, {"position": SQUARE}, "settled", ["A", "B"], [], cube, best
    )
    page = make_page(contents)
    assert len(page) < 2_500_000
    assert page.count('<g class="cell"') == 50 * 20
    assert page.count("<tr>") == 501
    data = read_data(page)
    assert data["parts"][0]["further"] == [2]
    code = "return runContest(part, 'position', 'settled', [49, 3, 9], Infinity, null)[0]"
    line = run_script(data, code)
    assert line["error"] == pytest.approx(np.sqrt(0.015 * 50.0), rel=1e-6)
    assert line["high"] is None


def test_the_axes_are_the_first_two_that_vary():
    conditions = [Condition(name, name) for name in "abc"]
    plane = choose_axes(conditions, {"a": [1.0], "b": [1.0, 2.0], "c": ["x", "y"]})
    assert (plane.across.name, plane.upwards.name) == ("b", "c")
    assert plane.list_off(conditions) == ["a"]
    three = choose_axes(conditions, {"a": [1.0, 2.0], "b": [1.0, 2.0], "c": ["x", "y"]})
    assert (three.across.name, three.upwards.name) == ("a", "b")
    alone = choose_axes([PERIOD], {"natural_period": [3.0]})
    assert alone.upwards is None


def test_an_open_cell_is_hatched_and_a_missing_one_has_no_result():
    contents = make_contents(RECORDS)
    cells = contents.cells.assign(verdict="open").iloc[2:]
    drawn = draw(replace(contents, cells=cells))
    assert drawn.count('fill="url(#hatch)"') == 5
    assert drawn.count(": no result") == 1


def test_a_page_without_a_map_has_no_script():
    page = make_run_page(
        "replay", {"": Shown(text="take HME1\nor MKF")}, ORIGIN, Extras(), exact=False
    )
    assert "take HME1\nor MKF" in page
    assert "script-src 'none'" in page
    assert 'id="data"' not in page
    assert make_document("a<b", "<p>x</p>").count("<title>a&lt;b</title>") == 1
