"""Rows and random streams of small runs are those of before the rebuild (`freezing.py`)."""

from __future__ import annotations

import freezing
import pytest

CORE = [study for study, told in freezing.STUDIES.items() if told["core"]]


@pytest.mark.parametrize("study", CORE)
def test_rows_of_the_core_are_frozen(study):
    assert freezing.check(study, freezing.STUDIES[study]["core"]) == []


@pytest.mark.faults
@pytest.mark.parametrize("study", freezing.STUDIES)
def test_all_rows_are_frozen(study):
    assert freezing.check(study) == []


@pytest.fixture(scope="module")
def kept():
    return freezing.read_rows("hub", ["superposed", "users"])[0]


def changed(rows, run, factor):
    """Rows with the largest motion term of a run times a factor."""
    rows = rows.copy()
    rows.loc[rows["motion"].where(rows["run"] == run).idxmax(), "motion"] *= factor
    return rows


@pytest.mark.parametrize(
    ("run", "factor", "same", "differs"),
    [
        ("superposed", 1.0 + 1e-10, True, False),
        ("superposed", 1.0 + 1e-8, True, True),
        ("users", 1.0 + 1e-10, False, False),
        ("users", 1.0 + 1e-8, False, True),
    ],
)
def test_how_near_numbers_must_be(kept, run, factor, same, differs):
    lines = freezing.compare("hub", changed(kept, run, factor), kept, same=same)
    assert [line.split(": ")[0] for line in lines] == [f"hub {run}"] * differs


def test_rows_that_lack_and_other_statuses_are_told(kept):
    (line,) = freezing.compare("hub", kept.drop(index=3), kept, same=True)
    assert line.startswith("hub: 1 rows are not made, 0 are new")
    assert freezing.compare("hub", kept.sample(frac=1.0, random_state=1), kept, same=True) == []
    other = kept.assign(status="failed")
    lines = freezing.compare("hub", other, kept, same=False)
    assert {line.split(" differs")[0] for line in lines} == {
        "hub superposed: status", "hub users: status",
    }  # fmt: skip


def test_another_spawn_key_and_another_first_normal_are_told():
    one = {"seed": 1, "key": ["hub", 0, "phase"], "generator": "SFC64", "normals": [0.1, 0.2, 0.3]}
    other = {**one, "key": ["hub", 1, "phase"]}
    new, gone = freezing.compare_streams("hub", [other], [one])
    assert "is new" in new
    assert "nobody draws" in gone
    (drawn,) = freezing.compare_streams("hub", [{**one, "normals": [0.1, 0.2, 0.4]}], [one])
    assert "begins with" in drawn
