"""Printed numbers: read as printed, and judged as those of one record."""

from pathlib import Path

import pandas as pd
import pytest

from experiments.maes2018.fidelity import compare_printed
from experiments.simpson2025.table_3 import compare_table, read_printed
from experiments.single_record import place_print
from owtsweep.config import conf_directory
from owtsweep.verdicts.claims_file import read_claims

ROOT = Path(__file__).parents[2]


def test_table_3_is_whole():
    table = read_printed()
    assert list(table.columns) == ["setup", "metric", "state", "value"]
    sizes = table.groupby(["setup", "metric"])["state"].nunique()
    assert len(table) == 72
    assert (sizes == 8).all()
    value = table.set_index(["setup", "metric", "state"])["value"]
    assert value["dense_x_a", "MAE", "x0_FA"] == 8e-6
    assert value["dense_theta_a", "TRAC", "x15_SS"] == 0.380
    assert value["sparse_theta_a", "FRAC", "x0_SS"] == 0.785
    assert value["sparse_theta_a", "MAE", "theta15_SS"] == 5e-7
    assert (value.xs("FRAC", level="metric") >= value.xs("TRAC", level="metric")).all()
    folder = conf_directory() / "studies" / "tower" / "sensors"
    assert set(table["setup"]) <= {path.stem for path in folder.glob("*.yaml")}


def test_trac_is_judged_by_its_distance_from_1_and_what_rounds_to_the_print_agrees():
    where = {"sea": "calm", "gravity": True, "weight": False, "scheme": "AKF", "tuning": "paper"}
    values = {
        ("x0", "trac"): [0.99999, 0.9998, 0.9997],  # printed: 1.000
        ("theta0", "trac"): [0.95, 0.951, 0.949],  # printed: 1.000
        ("x0", "mae"): [6e-6, 9e-6, 1.2e-5],  # printed: 8e-6
    }
    scores = pd.DataFrame(
        {**where, "sensors": "dense_x_a", "direction": "fa", "quantity": quantity,
         "measure": measure, "replicate": replicate, "value": value}
        for (quantity, measure), records in values.items()
        for replicate, value in enumerate(records)
    )  # fmt: skip
    table = compare_table(scores).set_index(["sensors", "metric", "state"])
    rows = table.loc["dense_x_a"]
    assert rows.loc[("TRAC", "x0_FA"), ["chance", "agrees"]].tolist() == [1.0, "yes"]
    assert rows.loc[("TRAC", "theta0_FA"), "agrees"] == "no"
    mae = place_print(7.5e-6, 8.5e-6, scores.query("measure == 'mae'")["value"].to_numpy())
    assert rows.loc[("MAE", "x0_FA"), "chance"] == pytest.approx(mae.chance)
    assert table.loc[("sparse_theta_a", "TRAC", "x0_FA"), "agrees"] == "undecided"  # no records


def test_a_printed_range_is_met_between_its_ends():
    values = {"difference_root_u": [0.015, 0.016], "difference_roll": [0.01, 0.0101]}
    scores = pd.DataFrame(
        {"scenario": "noise only", "scheme": "SMOOTHER", "measure": measure, "value": value}
        for measure, records in values.items()
        for value in records
    )
    table = compare_printed(scores).set_index(["scenario", "measure"]).loc["noise only"]
    assert table.loc["difference_root_u", "chance"] == 1.0
    assert table.loc["difference_roll", "agrees"] == "no"


def test_every_statement_says_where_it_is_printed_and_each_bound_why():
    file = read_claims(ROOT / "experiments/simpson2025/claims.toml")
    assert [one.name for one in file.statements] == [f"F{i}" for i in range(1, 15)]
    assert all(one.printed and one.definition for one in file.statements)
    assert [one.name for one in file.goals] == [f"G{i}" for i in range(1, 10)]
    assert all(claim.reason for one in file.statements for claim in one.claims)
