"""Tables over conditions that are not the hub's: any number of them, numbers and texts."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from soil_study import FACTOR, GRID, NOISE, SCHEMES, SOIL, leave, make_rows

from owtsweep.errors import InputError
from owtsweep.results.best_scheme import find_best_schemes, find_coinciding
from owtsweep.results.conditions import Condition, order_values, require_usable
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise

CHOICES = [(NOISE,), (FACTOR, NOISE), (SOIL, NOISE), (SOIL, FACTOR, NOISE)]


def make_cube(rows: pd.DataFrame, conditions: tuple[Condition, ...]) -> Cube:
    return Cube.of_rows(rows, SCHEMES, conditions, GRID, measures=("strain", "force"))


@pytest.mark.parametrize("conditions", CHOICES)
def test_the_summary_has_the_mean_of_every_cell(conditions):
    rows = make_rows(conditions)
    names = [condition.name for condition in conditions]
    table = summarise(make_cube(rows, conditions))
    keys = ["scheme", *names, "measure", "window"]
    assert list(table.columns) == [*keys, "mean", "ci_low", "ci_high", "n"]
    groups = rows.groupby(keys)["value"]
    assert len(table) == groups.ngroups
    for row in table.to_dict("records"):
        sample = groups.get_group(tuple(row[key] for key in keys))
        interval = stats.t.interval(0.95, 4, loc=sample.mean(), scale=stats.sem(sample))
        assert row["mean"] == pytest.approx(sample.mean(), rel=1e-12)
        assert (row["ci_low"], row["ci_high"]) == pytest.approx(interval, rel=1e-9)
    for name in names:  # texts as the grid lists them
        assert list(dict.fromkeys(table[name])) == list(GRID[name])
    values = make_cube(rows, conditions).to_table().assign(status="ok")
    told = summarise(make_cube(values, conditions)).set_index(keys)
    pd.testing.assert_frame_equal(told.loc[table.set_index(keys).index], table.set_index(keys))


@pytest.mark.parametrize("conditions", CHOICES)
def test_the_best_scheme_of_every_cell(conditions):
    rows = make_rows(conditions)
    names = [condition.name for condition in conditions]
    cube = make_cube(rows, conditions)
    table = find_best_schemes(cube, "full", ["force", "strain"])
    assert list(table.columns[: len(names) + 2]) == [*names, "criterion", "window"]
    assert len(table) == 2 * np.prod([len(GRID[name]) for name in names])
    means = rows.groupby([*names, "measure", "scheme"])["value"].mean()
    for row in table.to_dict("records"):
        cell = means.loc[(*(row[name] for name in names), row["criterion"])]
        assert [row["best"], row["runner_up"]] == cell.sort_values().index[:2].tolist()
    shuffled = make_cube(rows.sample(frac=1.0, random_state=1), conditions)
    pd.testing.assert_frame_equal(find_best_schemes(shuffled, "full", ["force", "strain"]), table)
    assert find_coinciding(cube, ["force"]) == []
    same = rows.copy()
    same.loc[same["scheme"] == "GDF", "value"] = same.loc[same["scheme"] == "DKF", "value"].mean()
    same.loc[same["scheme"] == "DKF", "value"] = same.loc[same["scheme"] == "DKF", "value"].mean()
    assert find_coinciding(make_cube(same, conditions), ["force"]) == [("DKF", "GDF")]


def test_a_scheme_that_is_unable_leaves_its_cell_and_says_why():
    conditions = (SOIL, NOISE)
    rows = make_rows(conditions)
    plain = make_cube(rows, conditions)
    assert "status" not in summarise(plain).columns
    rows = leave(rows, "DKF", "unstable", soil="sand", noise=1.0)
    rows = leave(rows, "ASKF", "blind", soil="sand", noise=1.0)
    cube = make_cube(rows, conditions)
    table = summarise(cube)
    assert list(table.columns[-3:]) == ["n", "status", "reason"]
    lost = table[table["status"] == "unable"]
    assert lost[["scheme", "soil", "noise", "reason", "n"]].to_numpy().tolist() == [
        ["ASKF", "sand", 1.0, "blind", 0],
        ["DKF", "sand", 1.0, "unstable", 0],
    ]
    assert lost["mean"].isna().all()
    at_sand = (table["soil"] == "sand") & (table["noise"] == 1.0) & (table["status"] == "ok")
    assert set(table[at_sand]["scheme"]) == {"GDF"}  # even in replicates that it had finished
    assert list(dict.fromkeys(table["scheme"])) == list(SCHEMES)
    best = find_best_schemes(cube, "full", ["strain"])
    first = best.iloc[0]
    assert (first["best"], first["runner_up"], first["status"]) == ("GDF", "", "unable")
    assert set(first["reason"].split("; ")) == {"ASKF: blind", "DKF: unstable"}
    assert set(best["status"][1:]) == {"ok"}
    values = cube.to_table()
    here = (values["soil"] == "sand") & (values["noise"] == 1.0)
    assert set(values[here]["scheme"]) == {"GDF"}


def test_a_superposed_scheme_that_is_unable_leaves_all_values():
    gain = Condition("gain", "gain", scale="log", enters="scale")
    rows = make_rows((SOIL,)).assign(gain=np.nan, motion=1.0, cross=0.0, noise=2.0)
    rows = leave(rows, "GDF", "no fix", soil="clay", gain=np.nan)
    cube = Cube.of_rows(rows, SCHEMES, (SOIL, gain), GRID | {"gain": [1.0, 3.0]})
    table = summarise(cube)
    lost = table[table["status"] == "unable"]
    assert lost[["soil", "gain"]].to_numpy().tolist() == [["clay", 1.0], ["clay", 3.0]]
    assert set(table[table["gain"] == 3.0]["mean"].dropna()) == {11.0}
    best = find_best_schemes(cube, "full", ["force"])
    assert best["reason"].tolist() == ["", "", "GDF: no fix", "GDF: no fix", "", ""]


def test_nothing_but_unable_schemes_still_has_a_summary():
    rows = leave(make_rows((NOISE,)).iloc[:0], "DKF", "unstable", noise=5.0)
    cube = make_cube(rows, (NOISE,))
    assert summarise(cube)["reason"].tolist() == ["unstable"]
    assert find_best_schemes(cube, "full", ["force"]).empty


def test_conditions_that_make_no_table_are_refused():
    gain = Condition("gain", "gain", enters="scale")
    with pytest.raises(InputError, match=r"^conditions: gain expands and is not the last"):
        require_usable((gain, NOISE))
    for conditions in ((), (NOISE, NOISE)):
        with pytest.raises(InputError, match=r"^conditions: \["):
            require_usable(conditions)


def test_values_and_titles_read_as_text():
    assert NOISE.show(5.0) == "5 %"
    assert FACTOR.show(0.5) == "0.5"
    assert SOIL.show("clay") == "clay"
    assert [c.title for c in (NOISE, FACTOR)] == ["sensor noise (%)", "soil stiffness factor"]
    assert FACTOR.word == "soil factor"
    assert order_values([3.0, 1.0, 3.0]) == [1.0, 3.0]
    assert order_values(["b", "x", "a"], ["b", "a"]) == ["b", "a", "x"]
