"""Why numbers are missed, whether filters know their errors, and the time histories at 3.8 s."""

from __future__ import annotations

import numpy as np
import pytest
from fidelity_worlds import EVERYTHING, Terms, make_evidence, printed, scattered_world, world
from scipy import stats
from tools import configure

from experiments.ren2019 import histories, reasons
from experiments.ren2019.consistency import judge_consistency, judge_intervals
from experiments.ren2019.evidence import Cell, Evidence
from experiments.ren2019.published import published_numbers
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import bias_of
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import simulate_bias


@pytest.fixture(scope="module")
def scattered() -> Evidence:
    return scattered_world()


@pytest.mark.parametrize(("part", "name"), [(0, "noise floor"), (1, "motion term")])
def test_the_reason_names_the_term_that_is_off(part, name):
    def off(measure: str, period: float) -> dict[str, Terms]:
        terms = {}
        for scheme, pair in printed(measure, period).items():
            terms[scheme] = tuple(9.0 * v if i == part else v for i, v in enumerate(pair))
        return terms

    cell = Cell(8.0, 1.0)
    evidence = world(off, measures=EVERYTHING)
    value = published_numbers().query("table == 8 and scheme == 'HME1' and measure == 'x'")
    why = reasons.reason(evidence, "HME1", cell, "x", float(value["published"].iloc[0]))
    assert (
        f"mainly the {name}: with the print's own the number would be within a factor of 1.00"
        in why
    )
    assert f"its {name} {'is ' if part == 0 else ''}9 times" in why


def test_start_up_share_by_brute_force(scattered):
    rows = scattered.rows[(scattered.rows["scheme"] == "MKF") & (scattered.rows["measure"] == "vy")]
    rows = rows[rows["natural_period"] == 8.0]
    squares = {}
    for window, part in rows.groupby("window"):
        mse = 0.04 * part["motion"] + 0.4 * part["cross"] + part["noise"]
        squares[window] = (mse * part["n_samples"]).sum()
    share = reasons.start_up_share(scattered, "MKF", Cell(8.0, 0.2), "vy")
    assert share == pytest.approx(1.0 - squares["settled"] / squares["full"])


def test_a_floor_that_single_records_could_fake_is_doubted():
    evidence = world(printed, measures=EVERYTHING)
    rows = evidence.rows.copy()
    rows["noise"] *= 3.0
    sure = make_evidence(rows)
    rows = rows.copy()
    rows["cross"] = np.where(rows["replicate"] % 2, 1.0, -1.0) * 0.1
    unsure = make_evidence(rows)
    arguments = ("EKF", Cell(8.0, 0.2), "x", 3.42e-3)
    assert "not well known" not in reasons.reason(sure, *arguments)
    assert "not well known" in reasons.reason(unsure, *arguments)


def test_consistency_by_brute_force(scattered):
    table = judge_consistency(scattered).set_index(["scheme", "natural_period", "amplitude"])
    assert len(table) == 4 * 6 * 10
    values = scattered.scores.table
    chosen = values[(values["scheme"] == "MKF") & (values["amplitude"] == 2.0)]
    chosen = chosen[(chosen["natural_period"] == 5.0) & (chosen["measure"] == "nees")]
    row = table.loc["MKF", 5.0, 2.0]
    nis = values[(values["measure"] == "nis") & (values["natural_period"] == 5.0)]
    nis = nis[(nis["scheme"] == "MKF") & (nis["amplitude"] == 2.0)]
    assert row["nis"] == pytest.approx(nis["value"].mean() / 2.0)
    assert row["nees"] == pytest.approx(chosen["value"].mean() / 4.0)
    half = stats.t.ppf(0.975, len(chosen) - 1) * stats.sem(chosen["value"]) / 4.0
    assert row["nees_high"] - row["nees"] == pytest.approx(half)


@pytest.mark.parametrize(
    ("nees", "nis", "verdict"),
    [
        ((1.1, 1.2), (0.9, 1.1), "optimistic"),
        ((0.9, 1.1), (0.7, 0.9), "pessimistic"),
        ((0.9, 1.1), (0.95, 1.05), "consistent"),
        ((1.1, 1.2), (0.8, 0.9), "mixed"),
        ((0.9, 9.0), (0.95, 1.05), "undecided"),
        ((np.nan, np.nan), (1.1, 1.2), "optimistic"),
        ((np.nan, np.nan), (np.nan, np.nan), "unknown"),
    ],
)
def test_verdict_on_a_cell(nees, nis, verdict):
    assert judge_intervals([nees, nis]) == verdict


def test_histories_are_those_of_the_sweep():
    """Their squared errors are those that the batch engine sums on the fly."""
    config = configure("record.duration=30", "grid.replicates=2")
    records = make_records(config, histories.NATURAL_PERIOD, [1])
    chain = resolve("HME2").kernel(Known(records.sensors, config), records.steps)
    bias = true_bias(config, records)
    errors = histories.absolute_errors(chain, records, bias)
    (direct,) = batch.sum_errors([chain], records, 1, histories.AMPLITUDE)
    squares = direct.products[:, :4, 2, 0].sum(axis=0)
    assert np.sum(errors["position"] ** 2, axis=0) == pytest.approx(squares[:2])
    assert np.sum(errors["velocity"] ** 2, axis=0) == pytest.approx(squares[2:])

    made = histories.measure_histories(config)
    assert set(made["replicate"]) == {0, 1}
    value = made.set_index(["scheme", "quantity", "measure", "replicate"])["value"]
    step = records.sensors.step
    for quantity, error in errors.items():
        assert value["HME2", quantity, "accumulated", 1] == pytest.approx(error.sum() * step)
    settled = round(config.measures.settling_time / step)
    share = np.mean(errors["velocity"][settled:] <= 0.05)
    assert value["HME2", "velocity", "share_inside", 1] == pytest.approx(share)


def true_bias(config, records):
    streams = records.stream(0)
    return next(simulate_bias(config.sensors, records.sensors, records.steps, streams))


def test_the_true_bias_is_that_of_the_sensors_turned_to_the_north():
    walk = "sensors.imu.bias_walk=0.0"
    config = configure(walk, "sensors.imu.bias_initial=0.3")
    records = make_records(config, 4.0, [0])
    bias = true_bias(config, records)
    expected = records.sensors.rotation @ np.array([0.3, 0.3])
    assert bias == pytest.approx(np.tile(expected, (len(bias), 1)))
    # x4 of Eq. (6) is -R b^b + g
    state = np.zeros((len(bias), 4, 2))
    state[:, 3] = -expected + np.array(config.sensors.gravity)
    assert bias_of(state, records.sensors) == pytest.approx(bias)


def test_no_histories_without_both_schemes():
    assert histories.measure_histories(configure("schemes=[MKF,HME1]")) is None
