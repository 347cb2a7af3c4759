"""A file becomes a record on the IMU's grid: truth, measurements, fixes at the right moments."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from replay_tools import collect_force, config_of, motion_file, sensor_file, write_csv

from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.of_sensors import align
from owtsweep.studies.replay.record import count_replicates, listen


def sine_file(path, rate=25.0, mean=2.0):
    time = np.arange(0.0, 60.0, 1.0 / rate) + 7.0
    x, y = np.sin(2 * np.pi * 0.25 * time) + mean, 0.5 * np.cos(2 * np.pi * 0.2 * time)
    return write_csv(path, {"time": time, "position_x": x, "position_y": y})


def test_a_motion_is_what_the_file_says_without_its_mean(tmp_path):
    config = config_of([sine_file(tmp_path / "a.csv")])
    record = load_record(config, config.grid.files[0])
    t = record.time_at(slice(None))
    inner = slice(500, -500)
    assert record.begin == pytest.approx(7.2)  # the first fix reports what was .2 s before
    assert record.origin[0] == pytest.approx(2.0, abs=0.02)
    omega = 2 * np.pi * np.array([0.25, 0.2])
    x = np.sin(omega[0] * t) + 2.0 - record.origin[0]
    assert np.max(np.abs(record.position[inner, 0] - x[inner])) < 1e-3
    assert np.max(np.abs(record.velocity[inner, 0] - omega[0] * np.cos(omega[0] * t)[inner])) < 2e-3
    vy = -0.5 * omega[1] * np.sin(omega[1] * t)
    assert np.max(np.abs(record.velocity[inner, 1] - vy[inner])) < 2e-3
    ax = -(omega[0] ** 2) * np.sin(omega[0] * t)
    assert np.max(np.abs(record.acceleration[inner, 0] - ax[inner])) < 5e-3


def test_the_mean_stays_if_asked_to(tmp_path):
    config = config_of([sine_file(tmp_path / "a.csv")], "replay.remove_mean=false")
    record = load_record(config, config.grid.files[0])
    assert not np.any(record.origin)
    assert record.position[:, 0].mean() == pytest.approx(2.0, abs=0.05)


def test_simulated_sensors_are_the_motion_and_the_noise(tmp_path):
    config = config_of(
        [sine_file(tmp_path / "a.csv")], "sensors.yaw=40", "sensors.gravity=[0.1,-0.2]"
    )
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, config.grid.files[0])
    measured = listen(config, sensors, record, 3)
    M, delay = sensors.fix_interval, sensors.delay
    late = record.position[M - delay :: M]
    apart = measured.fixes[1:] - late[: len(measured.fixes) - 1]
    assert 0.5 * 0.03 < apart.std() < 1.5 * 0.03
    in_ned = collect_force(measured) @ sensors.rotation.T
    rest = in_ned - record.acceleration + np.array([0.1, -0.2])  # - g
    assert rest.mean(axis=0) == pytest.approx([0.03, 0.067], abs=0.04)  # R b^b of .05, .05
    assert rest.std() == pytest.approx(0.15, rel=0.1)
    again = listen(config, sensors, record, 3)
    assert np.array_equal(collect_force(again), collect_force(measured))
    other = listen(config, sensors, record, 4)
    assert not np.array_equal(other.fixes, measured.fixes)


def test_recorded_fixes_stand_where_they_are_due(tmp_path):
    path = sensor_file(tmp_path / "a.csv", missing=(5, 6, 20), jitter=0.03, noise=0.0)
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    assert (record.gnss, count_replicates(config, record)) == ("recorded", 1)
    assert record.begin == pytest.approx(0.4, abs=0.02)
    assert np.flatnonzero(np.isnan(record.fixes[:, 0]))[:3].tolist() == [5, 6, 20]
    at = sensors.fix_interval * np.arange(1, 50) - sensors.delay
    there = np.isfinite(record.fixes[1:50, 0])
    apart = record.fixes[1:50][there] - record.position[at[there]]
    assert np.max(np.abs(apart)) < 0.02  # the phase of the grid is found to some 10 ms
    assert any("irregular by up to 0.0" in note for note in record.notes)
    assert any("3 of" in note and "missing" in note for note in record.notes)


def test_fixes_are_made_from_a_reference(tmp_path):
    path = sensor_file(tmp_path / "a.csv", fixes=False)
    config = config_of([path])
    sensors = sensing.sensors(config.sensors)
    record = load_record(config, str(path))
    assert record.gnss == "from_reference"
    assert count_replicates(config, record) == 20
    one, two = (listen(config, sensors, record, k) for k in range(2))
    assert np.array_equal(collect_force(one), collect_force(two))  # what was recorded stays
    noise = one.fixes - record.fixes
    assert noise.std() == pytest.approx(0.03, rel=0.25)
    assert not np.array_equal(one.fixes, two.fixes)
    at = sensors.fix_interval * np.arange(1, 50) - sensors.delay
    assert np.array_equal(record.fixes[1:50], record.position[at])


def test_a_gap_of_the_reference_is_a_gap_of_the_fixes_and_of_the_truth(tmp_path):
    import pandas as pd

    path = sensor_file(tmp_path / "a.csv", fixes=False)
    table = pd.read_csv(path)
    table.loc[(table.time > 20) & (table.time < 23.5), ["reference_x", "reference_y"]] = np.nan
    table.loc[table.time > 55, ["reference_x", "reference_y"]] = np.nan
    table.to_csv(path, index=False)
    record = load_record(config_of([path]), str(path))
    lost = np.isnan(record.position[:, 0])
    time = record.time_at(slice(None))
    inside = (time > 20.1) & (time < 23.4)
    assert np.all(lost[inside])
    assert np.all(lost[time > 55.1])
    assert not np.any(lost[(time < 19.9) | ((time > 23.6) & (time < 54.9))])
    assert np.isnan(record.fixes[:, 0]).sum() >= 3


def test_alignment_keeps_the_nearest_of_two_fixes():
    config = config_of([])
    sensors = sensing.sensors(config.sensors)
    time = np.array([0.5, 1.5, 2.5, 2.6, 4.5])
    values = np.column_stack([np.arange(5.0), np.arange(5.0)])
    found = align(time, values, 6.0, sensors)
    assert found.offset == pytest.approx(0.52, abs=0.011)
    assert found.values[:5, 0].tolist()[:3] == [0.0, 1.0, 2.0]
    assert np.isnan(found.values[3, 0])
    assert found.dropped == 1


def test_two_fixes_are_too_few(tmp_path):
    path = sensor_file(tmp_path / "a.csv", missing=range(2, 60))
    with pytest.raises(InputError, match=r"a.csv: columns.fix_x: .* holds 2 position fixes"):
        load_record(config_of([path]), str(path))


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["replay.input=sensors"], "there is no specific force"),
        (["columns.position_x=nonsense"], "nonsense"),
        (["measures.settling_time=80", "record.duration=2000"], "no longer than measures"),
        (["replay.cutoff=30"], "cutoff"),
    ],
)
def test_what_cannot_be_replayed_is_refused(tmp_path, overrides, message):
    path = motion_file(tmp_path / "a.csv")
    with pytest.raises(InputError, match=message):
        load_record(config_of([path], *overrides), str(path))


def test_a_wrong_gnss_rate_is_told_from_the_fixes(tmp_path):
    path = sensor_file(tmp_path / "a.csv")
    with pytest.raises(InputError, match=r"come every 1 s: set sensors.gnss.rate=1$"):
        load_record(config_of([path], "sensors.gnss.rate=0.8", "hme.mhe.interval=0.25"), str(path))


def test_fixes_that_a_logger_repeats_in_each_row_count_once(tmp_path):
    path = sensor_file(tmp_path / "a.csv", reference=False)
    once = load_record(config_of([path]), str(path))
    held = pd.read_csv(path)
    held[["fix_x", "fix_y"]] = held[["fix_x", "fix_y"]].ffill()
    held.to_csv(tmp_path / "held.csv", index=False)
    record = load_record(config_of([tmp_path / "held.csv"]), str(tmp_path / "held.csv"))
    assert np.array_equal(record.fixes, once.fixes)
    assert any("rows repeat the fix before them" in note for note in record.notes)


def test_a_force_needs_fixes_or_a_reference(tmp_path):
    path = sensor_file(tmp_path / "a.csv", fixes=False, reference=False)
    with pytest.raises(InputError, match="neither fixes nor a reference"):
        load_record(config_of([path]), str(path))


def fast_reference(path, noise):
    """Slow waves and a vibration at 8 Hz, as optics with a noise (m) of 100 Hz see them."""
    time = 0.01 * np.arange(6000)
    x = np.sin(2 * np.pi * 0.25 * time) + 0.01 * np.sin(2 * np.pi * 8.0 * time)
    seen = x + noise * np.random.default_rng(1).standard_normal(len(x))
    zero = np.zeros(len(x))
    columns = {"time": time, "specific_force_x": zero, "specific_force_y": zero}
    return write_csv(path, {**columns, "reference_x": seen, "reference_y": zero})


def test_a_reference_velocity_keeps_what_the_estimates_keep(tmp_path):
    """.5 m/s at 8 Hz: the IMU measures it, so a velocity without it would blame the estimates."""
    file = fast_reference(tmp_path / "a.csv", 1e-5)
    config = config_of([file])
    up_to_5 = changed(config, replay=changed(config.replay, cutoff=5.0))
    record, slow = load_record(config, str(file)), load_record(up_to_5, str(file))
    t = record.time_at(slice(None))
    waves = 0.5 * np.pi * np.cos(0.5 * np.pi * t)
    vibration = 0.16 * np.pi * np.cos(16 * np.pi * t)
    inner = slice(200, -200)
    assert np.max(np.abs(record.velocity[:, 0] - waves - vibration)[inner]) < 5e-3
    assert np.max(np.abs(slow.velocity[:, 0] - waves)[inner]) < 5e-3
    np.testing.assert_array_equal(record.position, slow.position)
    assert any("velocity is kept up to" in note for note in record.notes)
    assert not any("velocity is kept up to" in note for note in slow.notes)
    # with 3 cm of noise the band of clear motion ends before 5 Hz: noise must not become velocity
    noisy = fast_reference(tmp_path / "b.csv", 0.03)
    record, slow = load_record(config, str(noisy)), load_record(up_to_5, str(noisy))
    np.testing.assert_array_equal(record.velocity, slow.velocity)
