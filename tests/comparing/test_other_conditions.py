"""Comparing runs of a study that is not the hub: other conditions, with and without boundary."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from soil_study import FACTOR, GRID, NOISE, SCHEMES, SOIL, make_rows

from owtsweep.comparing.compare import compare
from owtsweep.comparing.comparison import Aspects, Candidate, Comparison, Findings, Pair
from owtsweep.comparing.report import describe_origins
from owtsweep.errors import InputError
from owtsweep.results.conditions import Condition

GAIN = Condition("gain", "sensor gain", scale="log", enters="scale")


def compare_runs(folder: Path, rows: list[pd.DataFrame], describe) -> Findings:
    config = SimpleNamespace(engine="batch")
    runs = tuple(
        Candidate(f"run{i}", f"hash{i}", config, table, {"q": float(i)})
        for i, table in enumerate(rows)
    )
    comparison = Comparison(("q",), (), runs, (Pair(0, 1, "q"),))
    return compare(comparison, folder, describe, metadata={"runs": "a b"})


def aspects(conditions, **changes):
    told = {
        "conditions": conditions,
        "grid": {condition.name: GRID[condition.name] for condition in conditions},
        "schemes": SCHEMES,
        "criterion": "strain",
        "window": "full",
        "pairing": {"seed": 1},
    }
    return Aspects(**(told | changes))


@pytest.mark.parametrize("conditions", [(NOISE,), (SOIL, NOISE), (SOIL, FACTOR, NOISE)])
def test_cells_and_schemes_are_compared_over_any_conditions(tmp_path, conditions):
    rows = make_rows(conditions)
    other = rows.copy()
    other.loc[other["scheme"] == "DKF", "value"] *= 3.0
    findings = compare_runs(tmp_path, [rows, other], lambda run: aspects(conditions))
    assert set(findings.tables) == {"runs", "best_schemes", "changed_cells", "scheme_changes"}
    table = findings.tables["scheme_changes"]
    names = [condition.name for condition in conditions]
    assert list(table.columns[4 : 6 + len(names)]) == ["scheme", *names, "criterion"]
    ratios = table.set_index("scheme")["ratio"]
    np.testing.assert_allclose(ratios.loc["DKF"], 3.0, rtol=1e-12)
    np.testing.assert_allclose(ratios.loc["GDF"], 1.0, rtol=1e-12)
    assert table["paired"].all()
    changed = findings.tables["changed_cells"]
    assert set(changed["best_from"]) == {"DKF"}
    assert "boundary" not in findings.report.lower()
    drawn = {path.name for path in findings.figures}
    if len(conditions) < 3:
        assert drawn == {"best_scheme_maps.png", "best_scheme_maps.svg"}
    else:
        assert not drawn
        assert any(note.startswith("no maps (map: soil, ") for note in findings.notes)


@pytest.mark.parametrize("outer", [(), (SOIL,)])
def test_a_boundary_along_the_condition_that_expands(tmp_path, outer):
    conditions = (*outer, GAIN)
    grid = {condition.name: GRID[condition.name] for condition in outer} | {"gain": [0.5, 1.0, 4.0]}
    products = {"ASKF": (1.0, 9.0), "DKF": (2.0, 1.0), "GDF": (1.0, 3.0)}
    rows = make_rows(outer or (NOISE,))
    if not outer:
        rows = rows[rows["noise"] == 1.0].drop(columns="noise")
    noise = [products[name][1] for name in rows["scheme"]]
    motion = [products[name][0] for name in rows["scheme"]]
    rows = rows.assign(gain=np.nan, motion=motion, cross=0.0, noise=noise, value=np.nan)
    told = aspects(conditions[:-1] or (NOISE,), grid=grid, boundary=("DKF", "GDF"))
    told = Aspects(**{**vars(told), "conditions": conditions})
    findings = compare_runs(
        tmp_path, [rows, rows.assign(motion=rows.motion / 4.0)], lambda run: told
    )
    boundaries = findings.tables["boundaries"]
    np.testing.assert_allclose(boundaries["boundary"][: len(boundaries) // 2], np.sqrt(2.0))
    np.testing.assert_allclose(findings.tables["boundary_shifts"]["ratio"], 2.0)
    assert "boundary" in findings.overview.columns
    assert {path.stem for path in findings.figures} == {"best_scheme_maps", "boundary"}


def test_what_cannot_be_compared_is_refused(tmp_path):
    rows = [make_rows((NOISE,))] * 2
    describe = {
        "grid.noise": lambda run: aspects((NOISE,), grid={"noise": [run.values["q"]]}),
        "schemes": lambda run: aspects((NOISE,), schemes=[f"own{run.values['q']}"]),
        "grid": lambda run: aspects((NOISE,) if run.values["q"] else (SOIL, NOISE)),
        "engine": lambda run: aspects((NOISE,), best_of=[None, print][int(run.values["q"])]),
        "measures.criterion": lambda run: aspects((NOISE,), criterion=f"m{run.values['q']}"),
    }
    for key, say in describe.items():
        with pytest.raises(InputError, match=rf"^{key}: "):
            compare_runs(tmp_path, rows, say)


def test_settings_that_differ_are_listed_up_to_four_values():
    told = [aspects((NOISE,), origin={"soil": "clay", "depth": f"{i} m"}) for i in range(6)]
    assert (
        describe_origins(told[:2]) == "In all runs: soil clay. The runs differ in depth (0 m, 1 m)."
    )
    assert describe_origins(told).endswith("depth (0 m, 1 m, 2 m, 3 m, ...).")
    assert describe_origins([aspects((NOISE,))] * 2) == ""


def test_another_seed_is_not_paired(tmp_path):
    rows = make_rows((NOISE,))
    findings = compare_runs(
        tmp_path, [rows, rows], lambda run: aspects((NOISE,), pairing={"seed": run.values["q"]})
    )
    assert any(note.startswith("seed differs between runs") for note in findings.notes)
    assert not findings.tables["scheme_changes"]["paired"].any()


def test_baselines_take_no_part_and_the_comparison_says_so(tmp_path):
    rows = [make_rows((NOISE,))] * 2
    findings = compare_runs(tmp_path, rows, lambda run: aspects((NOISE,), beside=["NONE"]))
    assert any(
        note.startswith("baselines (NONE) take no part: best is the best")
        for note in findings.notes
    )
    without = compare_runs(tmp_path, rows, lambda run: aspects((NOISE,)))
    assert not any("take no part" in note for note in without.notes)
