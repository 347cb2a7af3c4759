"""Every way of running a scheme over a record gives the same; what it states is what happens."""

from __future__ import annotations

import numpy as np
import pytest
from replay_tools import config_of, estimate, measure, motion_file, sensor_file

from owtsweep.config import changed
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import resolve
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import listen

SMALL = (
    "sensors.imu.rate=20", "hme.mhe.horizon=5", "hme.mhe.smoother_window=6", "hme.mhe.interval=0.5",
    "measures.settling_time=5",
)  # fmt: skip


@pytest.mark.parametrize("name", ["EKF", "MKF", "HME1", "HME2"])
@pytest.mark.parametrize("missing", [(), (3, 7, 8)])
def test_all_engines_agree(tmp_path, name, missing):
    path = sensor_file(tmp_path / "a.csv", duration=11.0, missing=missing)
    config = config_of([path], *SMALL)
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    measured = listen(config, sensors, record, 0)
    fast = estimate(config, resolve(name), sensors, measured)
    slow = estimate(changed(config, engine="reference"), resolve(name), sensors, measured)
    for part in ("state", "innovation", "innovation_covariance"):
        one, other = getattr(fast, part), getattr(slow, part)
        if part == "innovation_covariance":
            one, other = np.diagonal(one, axis1=1, axis2=2), np.diagonal(other, axis1=1, axis2=2)
        if name == "HME2" and part != "state":
            continue  # the reference states only the innovations at fixes
        scale = np.nanmax(np.abs(other))
        assert np.array_equal(np.isnan(one), np.isnan(other)), part
        assert np.nanmax(np.abs(one - other)) <= 1e-9 * scale, part
    if name in ("EKF", "MKF") or not missing:
        there = np.isfinite(fast.deviation) & np.isfinite(slow.deviation)
        apart = np.abs(fast.deviation - slow.deviation)[there]
        assert np.max(apart, initial=0.0) <= 1e-9


def test_the_deviation_grows_while_fixes_are_missing(tmp_path):
    path = sensor_file(tmp_path / "a.csv", missing=tuple(range(20, 30)))
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    found = estimate(config, resolve("HME1"), sensors, listen(config, sensors, record, 0))
    before, during = found.deviation[1950, 0], found.deviation[2950, 0]
    assert during > 3.0 * before
    assert found.deviation[4500, 0] == pytest.approx(found.deviation[4400, 0], rel=0.05)


def test_hme1_states_its_uncertainty_right(tmp_path):
    """94-96 % of the errors lie within ±1.96 sigma; 8 draws of the noise over 15 minutes."""
    path = motion_file(tmp_path / "a.csv", duration=900.0, rms=0.5)
    config = config_of([path], "tuning=matched")
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    shares = {"HME1": [], "MKF": []}
    for name, found in shares.items():
        for replicate in range(8):
            measured = listen(config, sensors, record, replicate)
            estimated = estimate(config, resolve(name), sensors, measured)
            rows = measure(record, measured.fixes, estimated, sensors, 2000)
            found += [v for n, w, v, _ in rows if (n, w) == ("coverage_position", "settled")]
    assert len(shares["HME1"]) == 8
    assert 0.94 <= np.mean(shares["HME1"]) <= 0.96
    assert np.mean(shares["MKF"]) < 0.94  # it does not know of its lag
