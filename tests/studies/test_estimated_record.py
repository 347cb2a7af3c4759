"""`owtsweep.estimate` shows the records that a sweep judges."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_tower import SMALL_TOWER

import owtsweep

BLADE = [
    "study=blade", "grid.sigma=[0.01]", "grid.outage=[10]", "record.duration=40",
    "record.settling=10", "schemes=[HOLD,MEKF,SMOOTHER]",
]  # fmt: skip
HUB = [
    "tuning=matched", "grid.natural_period=[4]", "grid.amplitude=[0.5]", "record.duration=60",
    "schemes=[EKF,HME1]", "baselines=[HOLD]", "evaluation=direct",
]  # fmt: skip
TOWER = [
    "study=tower", *SMALL_TOWER, "grid.noise=[1]", "grid.soil_factor=[1]",
    "schemes=[AKF,QUASI_STATIC]",
]  # fmt: skip
FLOATER = [
    "study=floater", "grid.delay=[0]", "grid.bias=[0]", "grid.snr=[20]", "grid.loss=[0]",
    "record.duration=30", "record.settling=10",
]  # fmt: skip


def _judge_as_a_sweep(overrides: list[str], measure: str, folder: Path) -> dict[str, float]:
    """Return scheme -> the value that a sweep stores for record 0, settled."""
    rows = owtsweep.run([*overrides, "grid.replicates=1", f"results={folder}"]).cases()
    rows = rows[(rows["measure"] == measure) & (rows["window"] == "settled")]
    return dict(zip(rows["scheme"], rows["value"], strict=True))


@pytest.mark.parametrize(
    ("overrides", "quantity", "measure"),
    [
        (BLADE, "root", "root"),
        (HUB, "position", "position"),
        (TOWER, "inputs_fa", "base_moment"),
        (FLOATER, "position", "mse_position_z"),
    ],
    ids=["blade", "hub", "tower", "floater"],
)
def test_errors_are_those_of_a_sweep(
    overrides: list[str], quantity: str, measure: str, tmp_path: Path
) -> None:
    record = owtsweep.estimate(overrides)
    expected = _judge_as_a_sweep(overrides, measure, tmp_path)
    assert set(expected) == set(record.estimates)
    for scheme, value in expected.items():
        true = record.truth[quantity][record.settled :]
        error = record.estimates[scheme][quantity][record.settled :] - true
        if measure == "root":
            found = np.sqrt(np.mean(np.sum(error**2, axis=1)))
        elif measure == "position":
            found = np.mean(np.sum(error**2, axis=1))
        elif measure == "base_moment":
            found = np.std(error[:, 1]) / np.std(true[:, 1])
        else:
            found = np.mean(error[:, 2] ** 2)
        assert found == pytest.approx(value, rel=1e-9), scheme


def test_a_tower_states_latencies_and_that_none_states_a_covariance() -> None:
    words = [word for word in TOWER if not word.startswith("schemes=")]
    record = owtsweep.estimate([*words, "schemes=[AKF,AKF_LAGGED,MDE]", "filters.lag=0.5"])
    assert record.latencies == {"AKF": 0.0, "AKF_LAGGED": 0.5, "MDE": 20.0}
    assert record.covariances == {"AKF": {}, "AKF_LAGGED": {}, "MDE": {}}


def test_what_a_record_holds() -> None:
    record = owtsweep.estimate(BLADE, replicate=1)
    steps = len(record.time)
    assert record.conditions["outage"] == 10.0
    assert record.covariances["MEKF"]["root"].shape == (steps, 3, 3)
    assert record.covariances["HOLD"] == {}
    assert record.latencies["SMOOTHER"] > record.latencies["MEKF"] == 0.0
    for name, reading in record.measurements.items():
        assert len(reading.time) == len(reading.value), name
    assert {*record.truth, *record.measurements} == set(record.units)
    other = owtsweep.estimate(BLADE)
    assert not np.array_equal(record.truth["root"], other.truth["root"])


@pytest.mark.parametrize(
    ("overrides", "replicate", "told"),
    [
        (BLADE[:3], -1, "replicate: -1 is no number of a record; give 0, 1, ..."),
        (
            ["study=blade"],
            0,
            "grid.sigma: 4 values, and a record is of one cell; choose one value, e.g. "
            "grid.sigma=[0.003]",
        ),
        (
            ["grid=small", "tuning=[paper,matched]"],
            0,
            "tuning: paper and matched are several tunings; choose, e.g. tuning=matched",
        ),
        (
            ["study=mating"],
            0,
            "study: 'mating' has no records of its own; use one of hub, tower, floater, blade",
        ),
    ],
)
def test_what_is_not_one_record(overrides: list[str], replicate: int, told: str) -> None:
    with pytest.raises(owtsweep.InputError) as error:
        owtsweep.estimate(overrides, replicate)
    assert str(error.value) == told
