"""The same seed gives the same bits, and all schemes and settings see the same draws."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure, rows_of

from owtsweep.studies.hub.batch import sum_errors
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records


@pytest.mark.usefixtures("kernels")
def test_grid_order_does_not_show() -> None:
    one = rows_of(configure("grid.natural_period=[4.0,6.0]", "schemes=[MKF,HME1]"))
    for changes in (
        ("grid.natural_period=[6.0,4.0]", "schemes=[HME1,MKF]"),
        ("grid.natural_period=[6.0]", "schemes=[EKF,HME1]", "grid.amplitude=[3.0]"),
    ):
        other = rows_of(configure(*changes))
        common = other.keys() & one.keys()
        assert len(common) == len(one) // (4 if "[6.0]" in changes[0] else 1)
        for key in common:
            for product in ("motion", "cross", "noise"):
                assert other[key][product] == one[key][product], key


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("name", ["EKF", "MKF", "HME1", "HME2"])
def test_the_number_of_lanes_does_not_show(name: str) -> None:
    config = configure()
    many = make_records(config, 4.0, range(8))
    chain = resolve(name).kernel(Known(many.sensors, config), many.steps)
    for amplitude in (None, 0.7):
        whole = sum_errors([chain], many, 100, amplitude)[0].products
        for few in ([3], [3, 5, 6]):
            records = make_records(config, 4.0, few)
            part = sum_errors([chain], records, 100, amplitude)[0].products
            np.testing.assert_array_equal(part, whole[..., few])


@pytest.mark.parametrize(
    "changes",
    [
        ("sensors.gnss.delay=0.65",),
        ("sensors.gnss.sigma=0.06",),
        ("sensors.imu.sigma=0.3",),
        ("sensors.imu.bias_walk=0.002", "sensors.imu.bias_initial=0.1"),
        ("hme.smoother_window=9", "mkf.q_a=3"),
        ("sensors.yaw=-10",),
    ],
    ids=str,
)
def test_settings_keep_the_draws(changes: tuple[str, ...]) -> None:
    # doubling is exact in binary, so the draws can be compared bit for bit
    base, changed = configure("sensors.gravity=[0,0]"), configure("sensors.gravity=[0,0]", *changes)
    before, after = (make_records(c, 4.0, [2]) for c in (base, changed))
    np.testing.assert_array_equal(after.motion[0].position, before.motion[0].position)
    scale = changed.sensors.gnss.sigma / base.sensors.gnss.sigma
    np.testing.assert_array_equal(after.noise[0].fixes, scale * before.noise[0].fixes)
    quiet = ("sensors.imu.bias_walk=0", "sensors.imu.bias_initial=0")  # white noise alone
    before, after = (
        make_records(configure("sensors.gravity=[0,0]", *own, *quiet), 4.0, [2])
        for own in ((), changes)
    )
    scale = changed.sensors.imu.sigma / base.sensors.imu.sigma
    np.testing.assert_array_equal(
        after.noise[0].specific_force, scale * before.noise[0].specific_force
    )


def test_tuning_keeps_the_records() -> None:
    one, other = (make_records(configure(tuning=t), 4.0, [0]) for t in ("paper", "matched"))
    np.testing.assert_array_equal(one.noise[0].specific_force, other.noise[0].specific_force)
    np.testing.assert_array_equal(one.noise[0].fixes, other.noise[0].fixes)
    np.testing.assert_array_equal(one.motion[0].acceleration, other.motion[0].acceleration)


def test_a_longer_record_or_a_faster_gnss_changes_no_other_draw() -> None:
    base, longer, faster = (
        make_records(configure("schemes=[MKF]", *changes), 4.0, [0]).noise[0]
        for changes in ((), ("record.duration=60",), ("sensors.gnss.rate=4",))
    )
    steps, fixes = len(base.specific_force), len(base.fixes)
    np.testing.assert_array_equal(longer.specific_force[:steps], base.specific_force)
    np.testing.assert_array_equal(longer.fixes[:fixes], base.fixes)
    np.testing.assert_array_equal(faster.specific_force, base.specific_force)


def test_replicates_periods_and_seeds_differ() -> None:
    def first(config, period: float, replicate: int) -> float:
        return float(make_records(config, period, [replicate]).noise[0].fixes[0, 0])

    config = configure()
    values = {
        first(config, 4.0, 0), first(config, 4.0, 1), first(config, 4.000001, 0),
        first(configure("seed=7"), 4.0, 0),
    }  # fmt: skip
    assert len(values) == 4
