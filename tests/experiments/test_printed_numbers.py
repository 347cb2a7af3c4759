"""What Simpson et al. (2025) print is read as printed."""

from pathlib import Path

from experiments.simpson2025.table_3 import read_printed
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


def test_every_statement_says_where_it_is_printed_and_each_bound_why():
    file = read_claims(ROOT / "experiments/simpson2025/claims.toml")
    assert [one.name for one in file.statements] == [f"F{i}" for i in range(1, 15)]
    assert all(one.printed and one.definition for one in file.statements)
    assert [one.name for one in file.goals] == [f"G{i}" for i in range(1, 10)]
    assert all(claim.reason for one in file.statements for claim in one.claims)
