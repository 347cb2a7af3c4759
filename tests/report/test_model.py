"""What a page computes is what Python has computed: run in node, without a browser."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pages import PERIOD, SQUARE, make_contents, run_script

from owtsweep.report.data import MOST_CELLS, make_part
from owtsweep.report.statistics import find_looks, gather_records
from owtsweep.results.superposition import superpose
from owtsweep.statistics.inference import mean_and_error, t_quantile

RECORDS = {"A": 32, "B": 32, "C": 16, "NONE": 8}
CONTEST = """
    const found = [];
    const state = {window: part.window, records: Infinity};
    for (const {name} of part.criteria) {
      for (const {at} of listMapCells(part, part.conditions.map(() => 0))) {
        const judged = judgeCell(part, {...state, criterion: name}, at);
        const records = countRecords(part, {...state, criterion: name}, at);
        const lines = runContest(part, name, part.window, at, records, null);
        found.push({name, at, judged, lines});
      }
    }
    return found;
"""


def make_data(contents, **options):
    return {"parts": [make_part("", contents, exact=False, **options)]}


@pytest.mark.parametrize("superposed", [True, False])
def test_every_cell_has_the_verdict_and_the_errors_of_the_table(superposed):
    contents = make_contents(RECORDS, superposed=superposed)
    best = contents.cells
    found = run_script(make_data(contents), CONTEST)
    names = contents.cube.names
    assert len(found) == len(best) == 12
    for cell in found:
        values = [levels[i] for levels, i in zip(contents.cube.levels, cell["at"], strict=True)]
        row = best[(best["criterion"] == cell["name"])]
        for name, value in zip(names, values, strict=True):
            row = row[row[name] == value]
        (row,) = row.to_dict("records")
        judged = cell["judged"]
        for here, there in (
            ("best", "best"), ("next", "runner_up"), ("verdict", "verdict"),
            ("error", "error_best"), ("nextError", "error_runner_up"),
        ):  # fmt: skip
            assert judged[here] == row[there]
        lines = {contents.cube.schemes[line["scheme"]]: line for line in cell["lines"]}
        # computed on the page, of means and covariances
        assert lines[row["best"]]["error"] == pytest.approx(row["error_best"], rel=1e-5)
        assert lines[row["best"]]["low"] == pytest.approx(row["error_low"], rel=1e-5)
        assert lines[row["best"]]["high"] == pytest.approx(row["error_high"], rel=1e-5)
        assert lines[row["runner_up"]]["error"] == pytest.approx(row["error_runner_up"], rel=1e-5)
        assert lines["NONE"]["error"] == pytest.approx(row["error_baseline"], rel=1e-5)


def test_any_amplitude_of_a_linear_scheme_agrees_with_its_records():
    contents = make_contents({**RECORDS, "NONE": 16})
    code = 'return runContest(part, "position", "full", [1, 0], 16, 0.77)'
    lines = run_script(make_data(contents), code)
    measure, window = (list(x).index(y) for x, y in (
        (contents.cube.measures, "position"), (contents.cube.windows, "full"),
    ))  # fmt: skip
    products = contents.cube.products[:, :, 1, measure, window, :16]
    values = superpose(*products, 0.77)
    assert [line["n"] for line in lines] == [16] * 4
    for line in lines:
        mean, error, n = mean_and_error(values[line["scheme"]])
        assert n == 16
        assert line["error"] == pytest.approx(math.sqrt(mean), rel=1e-6)
        half = t_quantile(15) * error
        assert line["high"] == pytest.approx(math.sqrt(mean + half), rel=1e-6)
    first, second = (values[line["scheme"]] for line in lines[:2])
    mean, error, _ = mean_and_error(second - first)
    half = t_quantile(15) * error
    for end, sign in (("ratioLow", -1.0), ("ratioHigh", 1.0)):
        expected = math.sqrt(1.0 + (mean + sign * half) / first.mean())
        assert lines[1][end] == pytest.approx(expected, rel=1e-5)


def test_schemes_that_nearly_coincide_keep_their_small_difference():
    contents = make_contents({"A": 32, "B": 32, "NONE": 8})
    products = contents.cube.products
    products[:, 1] = products[:, 0] * (1.0 + 1e-7 * np.arange(32))  # far below 32 bits of squares
    looks = find_looks(gather_records(contents.cube, "position", SQUARE, "settled")[0])
    look = looks[-1]
    weights = np.array([0.01, 0.2, 1.0])
    apart = np.float32(look.factor) @ np.concatenate([weights, -weights])
    of_one = np.float32(look.factor) @ np.concatenate([weights, 0.0 * weights])
    assert np.linalg.norm(apart) < 1e-5 * np.linalg.norm(of_one)


def test_a_scheme_that_failed_in_a_record_is_paired_with_nobody():
    contents = make_contents({"A": 8, "B": 8, "NONE": 8})
    contents.cube.products[:, 1, ..., 2] = np.nan
    lines = run_script(
        make_data(contents),
        'return runContest(part, "position", "settled", [0, 1], Infinity, null)',
    )
    of_b = next(line for line in lines if contents.cube.schemes[line["scheme"]] == "B")
    assert of_b["n"] == 7
    assert of_b["paired"] == 0
    assert not of_b["close"]


def test_one_record_has_no_interval_and_a_large_map_means_alone():
    contents = make_contents({"A": 1, "B": 1, "NONE": 1})
    code = 'return runContest(part, "position", "settled", [0, 0], Infinity, null)'
    lines = run_script(make_data(contents), code)
    assert [line["low"] for line in lines] == [None] * 3
    assert lines[0]["error"] > 0.0
    assert MOST_CELLS == 1000
    values = gather_records(contents.cube, "position", SQUARE, "full")
    looks = find_looks(values[0], means_only=True)
    assert [len(look.factor) for look in looks] == [0]


def test_copied_cells_are_no_formulas():
    code = """
        const rows = [["=1+1", 3], ["-A", -0.5], ["@x, y", NaN], ['say "so"', null]];
        return toCsv(["scheme", "n"], rows);
    """
    contents = make_contents({"A": 8, "NONE": 8})
    text = run_script(make_data(contents), code)
    assert text.split("\r\n") == [
        "scheme,n", "\"'=1+1\",3", "\"'-A\",-0.5", "\"'@x, y\",", '"say ""so""",', "",
    ]  # fmt: skip


def test_the_table_is_sorted_and_filtered():
    contents = make_contents(RECORDS)
    code = """
        const state = {criterion: "position", window: part.window, records: Infinity};
        const cells = listMapCells(part, [0, 0])
          .map(({at}) => ({at, shown: judgeCell(part, state, at)}));
        const columns = listColumns(part, state);
        const number = columns.findIndex(({label}) => label === "error (m)");
        const order = {sorted: number, down: true, filter: "natural"};
        const down = arrangeCells(cells, columns, {sorted: number, down: true, filter: ""});
        return {
            errors: down.map(({shown}) => shown.error),
            none: arrangeCells(cells, columns, order).length,
            four: arrangeCells(cells, columns, {sorted: null, filter: "NONE"}).length,
            labels: columns.map(({label}) => label),
        };
    """
    found = run_script(make_data(contents), code)
    assert found["errors"] == sorted(found["errors"], reverse=True)
    assert found["none"] == 0
    assert found["four"] == 6
    assert found["labels"][0] == PERIOD.title
    assert "error (m)" in found["labels"]


@pytest.mark.parametrize("superposed", [True, False])
def test_single_records_are_those_of_the_rows(superposed):
    contents = make_contents(RECORDS, superposed=superposed)
    code = 'return listRecords(part, "speed", "full", [1, 2], null)'
    assert run_script(make_data(contents), code) == []
    shown = run_script(make_data(contents, details={"cells": [], "spectra": []}), code)
    assert [len(errors) for errors in shown] == [32, 32, 16, 8]
    cube = contents.cube
    at = cube.measures.index("speed"), cube.windows.index("full")
    for scheme, errors in enumerate(shown):
        values = cube.values(scheme, (1,))[2, at[0], at[1], : len(errors)]
        expected = np.sqrt(values) if superposed else values
        np.testing.assert_allclose(errors, expected, rtol=1e-6)


def test_a_stretch_is_linear_in_the_amplitude():
    from owtsweep.sweep.page import pack

    contents = make_contents(RECORDS)
    truth, motion, noise = np.random.default_rng(3).normal(size=(3, 50))
    cells = [
        {
            "at": [1, place], "start": 20.0, "step": 0.1,
            "series": [pack("", N * truth), pack("A", N * motion + noise)],
        }
        for place, N in ((0, 0.1), (2, 2.0))
    ]  # fmt: skip
    details = {"label": "position (m)", "cells": cells, "spectra": []}
    code = "return [findStretch(part, [1, 1], null), findStretch(part, [0, 1], null)]"
    shown, missing = run_script(make_data(contents, details=details), code)
    assert missing is None
    assert [curve["name"] for curve in shown["values"]] == ["truth", "A"]
    errors = np.array([point[1] for point in shown["errors"][0]["points"]])
    np.testing.assert_allclose(errors, 0.5 * motion + noise, atol=3e-4)
    assert shown["errors"][0]["points"][1][0] == pytest.approx(20.1)
