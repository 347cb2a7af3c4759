"""What the blade study says of its paper: both systems, their differences, statements and goals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hanging import QUIET

from experiments.maes2018.fidelity import write_report
from experiments.maes2018.processing import process
from experiments.maes2018.scenarios import REFERENCE, make_record
from experiments.maes2018.scores import (
    SCENARIOS,
    score,
    score_boom,
    score_geometry,
    score_reference,
)
from owtsweep.verdicts.claims_file import read_claims

ROOT = Path(__file__).parents[2]

SHORT = ("record.duration=100", "record.settling=20")


def test_both_systems_show_the_motion() -> None:
    """Without noise what is left is the interpolation of total stations."""
    record = make_record([*SHORT, *QUIET], 0)
    motions = process(record.truth, record.run("SMOOTHER"), record.measured)
    assert motions.inertial == pytest.approx(motions.true, abs=1e-5)
    many = make_record([*SHORT, *QUIET, "sensors.prism_rate=20"], 0)
    motions = process(many.truth, many.run("SMOOTHER"), many.measured)
    assert motions.stations == pytest.approx(motions.true, abs=1e-3)
    assert np.diff(motions.time) == pytest.approx(0.2)


def test_each_error_of_the_reference_is_seen_where_it_must() -> None:
    """A bent blade moves the root along the blade by its share; a clock moves what moves."""
    found = {
        words: score_reference(make_record([*SHORT, *QUIET, "sensors.prism_rate=20", *words], 0))
        for words in ((), ("sensors.stretch=0.05",), ("sensors.prism_offset=0.1",))
    }
    none, bent, late = found.values()
    assert none["difference_root_u"] < 1e-3
    assert bent["difference_root_u"] == pytest.approx(0.05 * 14.0 / 26.0, rel=0.02)
    assert bent["difference_root_v"] < 2e-3
    record = make_record(SHORT, 0)
    speed = record.truth.root_velocity[record.judged.settled :]
    moved = 0.1 * np.sqrt(np.mean(speed**2, axis=0))
    for axis, name in enumerate("uvw"):
        assert late[f"difference_root_{name}"] == pytest.approx(moved[axis], rel=0.05)
    assert late["offset"] == pytest.approx(0.1, abs=1e-3)


def test_the_boom_is_judged_in_both_forms() -> None:
    found = score_boom(make_record(SHORT, 0))
    assert found["boom"] < 0.2 < found["boom_moved"] < found["boom_causal"]
    assert found["slow_kept"] < 0.01


def test_geometry_is_exact() -> None:
    found = score_geometry(0)
    assert max(found["pose"], found["reflection"], found["root_over_lever"]) < 1e-12
    assert found["cog_over_lever"] == pytest.approx(1.0)


def test_each_record_has_its_own_number() -> None:
    found = score("late clock", range(2), SHORT).set_index(["replicate", "measure"])["value"]
    for number in range(2):
        alone = score_reference(make_record([*REFERENCE["late clock"], *SHORT], number))
        assert found[number].to_dict() == alone
    first, second = (make_record(SHORT, number) for number in range(2))
    assert not np.allclose(first.truth.root, second.truth.root)
    noises = [record.measured.rate - record.truth.rate for record in (first, second)]
    assert not np.allclose(*noises)


def test_every_statement_and_goal_is_judged(tmp_path: Path) -> None:
    tables = [score(name, range(2), SHORT) for name in SCENARIOS]
    files = write_report(pd.concat(tables, ignore_index=True), tmp_path)
    assert {file.name for file in files} == {
        "scores.csv", "printed.csv", "fidelity_claims.csv", "fidelity.md", "fidelity.html",
    }  # fmt: skip
    told = (tmp_path / "fidelity.md").read_text()
    assert "missing" not in told.split("## In short")[1].split("## Statements")[0]
    file = read_claims(ROOT / "experiments/maes2018/claims.toml")
    for statement in (*file.statements, *file.goals):
        assert f"### {statement.name}: " in told
    assert "| both |" in told
