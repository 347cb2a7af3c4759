"""The paper's cases run, are judged rightly on made-up numbers, and are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from experiments.simpson2025 import scenarios, scores
from experiments.simpson2025.fidelity import write_report
from experiments.simpson2025.figures import FIGURES
from experiments.simpson2025.scenarios import Scenario, run_scenarios
from experiments.simpson2025.table_3 import compare_table, show_table
from owtsweep.studies.tower.contract import INPUTS
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED
from owtsweep.verdicts.judge import judge
from owtsweep.verdicts.score_table import ScoreTable

ROOT = Path(__file__).parents[2]

SHORT = ["record.duration=14", "record.settling=2", "truth.subdivision=1"]
RECORDS = 4
#: One figure of each kind; the others are drawn by the same functions.
DRAWN = ("figure_04", "figure_05", "figure_06", "figure_07", "figure_10", "figure_13_yaw_0")
STATES = ("x0", "theta0", "x15", "theta15")


@pytest.fixture(scope="module")
def results():
    needed = dict.fromkeys(scenario for name in DRAWN for scenario in FIGURES[name].needs)
    return dict(run_scenarios(needed, 0, SHORT))


@pytest.fixture(scope="module")
def holding() -> pd.DataFrame:
    """Return a table of scores with which every statement and goal holds."""
    rows = []
    for scenario in scenarios.ALL:
        for direction in ("fa", "ss"):
            where = {
                "sensors": scenario.sensors, "sea": scenario.sea, "gravity": scenario.gravity,
                "weight": scenario.weight, "scheme": scenario.scheme, "tuning": scenario.tuning,
                "direction": direction,
            }  # fmt: skip
            for quantity, measure, value in _hold(scenario, direction):
                row = {**where, "quantity": quantity, "measure": measure, "value": value}
                rows += [{**row, "replicate": replicate} for replicate in range(RECORDS)]
    table = pd.DataFrame(rows)
    scatter = np.random.default_rng(1).uniform(0.999, 1.001, len(table))
    table["value"] *= np.where(table["measure"].isin(["trac", "frac", "least_trac"]), 1.0, scatter)
    return scores.add_judged_welds(table)


def judge_some(table: pd.DataFrame, *names: str) -> dict[str, str]:
    """Return the verdict on each statement and goal, or on those named: each is judged alone."""
    file = read_claims(ROOT / "experiments/simpson2025/claims.toml")
    chosen = [one for one in (*file.statements, *file.goals) if not names or one.name in names]
    return {one.name: one.verdict for one in judge(chosen, [ScoreTable(table)], file)}


def spoil(table: pd.DataFrame, quantity: str, measure: str, value: float, **where: str):
    """Return scores in which one number is another everywhere (or where columns have values)."""
    chosen = (table["quantity"] == quantity) & (table["measure"] == measure)
    for column, text in where.items():
        chosen &= table[column] == text
    assert chosen.any()
    return table.assign(value=table["value"].mask(chosen, value))


def _hold(scenario: Scenario, direction: str):
    dense, weight = scenario.sensors.startswith("dense"), scenario.gravity
    drifting = scenario.sensors in ("dense_theta_a", "sparse_theta_a")
    for state in STATES:
        moves = drifting and state.startswith("x")
        yield state, "trac", 0.5 if moves else 0.9999
        yield state, "frac", 0.9 if moves else 0.9999
        yield state, "mae", 1e-6
        yield state, "relative_mae", 0.01
        yield state, "early_error", 1.0 if drifting else 1e-3
        yield state, "late_error", 9.0 if drifting else 1e-3
    for name in INPUTS:
        yield name, "trac", 0.998
        yield name, "mae", 1.0 if dense else 3.0
        yield name, "lag", 0.001 if dense else 0.1
        yield name, "offset", 5e4 if weight else 1.0
        yield name, "mean", 1e6
        yield name, "mode_ratio", 0.5 if scenario.sea != "calm" else 1.0
        yield name, "mode_shift", 0.001
    yield "modes", "other_error", 0.1
    yield "modes", "rigid_error", 100.0
    yield "modes", "least_trac", 0.9999
    low = scenario.sea != "calm" and scenario.scheme == "AKF"
    side = scenario.sea == "waves" and direction == "ss"
    yield "z=0", "damage", 1e-6
    yield "z=0", "damage_ratio", 0.3 if low and not side else 1.01
    yield "welds", "worst_deviation", 0.05
    yield "welds", "worst_factor", 1e6 if scenario.sensors == "accelerometers" else 1.05
    yield "filter", "seconds_per_step", 1e-5
    yield "filter", "unseen", 2.0 if drifting else 0.0


def test_statements_hold_where_they_should(holding):
    verdicts = judge_some(holding)
    assert set(verdicts.values()) == {REPRODUCED}
    assert len(verdicts) == 23


@pytest.mark.parametrize(
    ("name", "quantity", "measure", "value"),
    [
        ("F1", "theta15", "trac", 0.99),
        ("F2", "x0", "trac", 0.99),
        ("F3", "modes", "other_error", 50.0),
        ("F4", "x15", "frac", 0.4),
        ("F5", "welds", "worst_deviation", 0.3),
        ("F7", "F0", "lag", 0.02),
        ("F8", "F175", "offset", 5e4),
        ("F9", "z=0", "damage_ratio", 0.7),
        ("F10", "z=0", "damage_ratio", 0.8),
        ("F11", "F0", "mode_ratio", 1.0),
        ("F12", "filter", "unseen", 1.0),
        ("F13", "welds", "worst_factor", 1.5),
        ("F14", "filter", "seconds_per_step", 0.002),
        ("G1", "theta0", "relative_mae", 0.03),
        ("G2", "M175", "trac", 0.98),
        ("G3", "M0", "trac", 0.98),
        ("G4", "z=0", "judged_damage_ratio", 1.2),
        ("G6", "z=0", "damage_ratio", 1.3),
        ("G7", "F175", "offset", 5e4),
        ("G8", "filter", "unseen", 1.0),
        ("G9", "theta0", "relative_mae", 0.03),
    ],
)
def test_a_statement_falls_with_its_number(holding, name, quantity, measure, value):
    spoilt = spoil(holding, quantity, measure, value)
    assert judge_some(spoilt, name) == {name: NOT_REPRODUCED}


def test_inputs_of_both_dense_setups_are_compared(holding):
    made = spoil(holding, "F0", "trac", 0.9, sensors="dense_x_a")
    assert judge_some(made, "F6") == {"F6": NOT_REPRODUCED}


def test_a_statement_without_scores_is_missing(holding):
    made = holding[holding["sensors"] != "sparse_gnss"]
    assert judge_some(made, "F12") == {"F12": MISSING}


def test_damage_counts_where_it_is_a_hundredth_of_the_largest(holding):
    ground = holding[(holding["quantity"] == "z=0") & holding["measure"].str.startswith("damage")]
    other = ground.assign(quantity="z=9")
    is_damage = other["measure"] == "damage"
    for part, counts in ((0.009, False), (0.011, True)):
        value = other["value"].where(~is_damage, part * other["value"])
        made = scores.add_judged_welds(pd.concat([ground, other.assign(value=value)]))
        judged = made[made["measure"] == "judged_damage_ratio"]
        assert set(judged["quantity"]) == ({"z=0", "z=9"} if counts else {"z=0"})
        assert len(judged) == len(ground) / 2 * (1 + counts)


def test_sensors_are_those_of_table_2(results):
    for name, count in (("dense_x_a", 40), ("dense_theta_a", 40), ("sparse_theta_a", 10)):
        outcome = results[Scenario(name)]["fa"]
        assert len(outcome.setting.channels) == count


def test_one_record_is_the_truth_of_all_scenarios(results):
    first, *others = (results[scenario]["fa"] for scenario in scenarios.WIND.values())
    for other in others:
        assert other.truth is first.truth


def test_scores_are_those_of_their_definitions(results):
    outcome = results[Scenario()]["fa"]
    table = scores.tabulate([outcome]).set_index(["quantity", "measure"])["value"]
    true = outcome.truth.inputs[outcome.judged, 1]
    error = outcome.estimates.inputs[outcome.judged, 1] - true
    assert table["M0", "mae"] == pytest.approx(np.abs(error).mean())
    assert table["M0", "relative_mae"] == pytest.approx(np.abs(error).mean() / true.std())
    assert table["M0", "offset"] == pytest.approx(error.mean())
    assert table["filter", "unseen"] == 2.0  # position and velocity of the rigid translation
    # modal coordinates give back what the reduced model can show
    moved = outcome.estimates.displacement[-5:]
    back = outcome.project(moved) @ outcome.setting.reduced.basis.T
    np.testing.assert_allclose(back, moved, atol=1e-9 * np.abs(moved).max())


def test_figures_are_drawn(results):
    from owtsweep.figures import style

    with style.context():
        for name in DRAWN:
            figure = FIGURES[name]
            drawn = figure.draw({s: results[s] for s in figure.needs})
            assert len(drawn.axes) >= 3, name


def test_the_report_and_table_3_are_whole(holding, results, tmp_path):
    table = compare_table(holding)
    assert len(table) == 72
    assert not table[["published", "mean"]].isna().any(axis=None)
    assert len(show_table(table).rows) == 9
    files = write_report(holding, results[Scenario()]["fa"].config, tmp_path)
    page = (tmp_path / "fidelity.md").read_text()
    assert {"fidelity.md", "fidelity.html", "table_3.csv"} <= {file.name for file in files}
    assert "14 reproduced" in page
    assert "9 reproduced" in page
