"""What titles, `compare` and `vary` say of sensors that the paper does not have."""

from __future__ import annotations

import pytest
from tools import SMALL

from owtsweep.studies import compose
from owtsweep.studies.hub.describe import describe_origin, list_origin, list_sensors
from owtsweep.studies.hub.varying import list_common_facts

#: Override -> name and value in words of a fault that the paper's sensors do not have.
FAULTS = {
    "sensors.imu.tilt=0.0137": ("IMU tilt", "0.0137 rad/m"),
    "sensors.imu.high_pass=0.02": ("IMU high-pass", "0.02 Hz"),
    "sensors.gnss.scale=1.05": ("GNSS scale", "1.05"),
}


@pytest.mark.parametrize("word", FAULTS)
def test_titles_compare_and_vary_name_the_fault_of_a_sensor(word: str) -> None:
    name, value = FAULTS[word]
    config = compose([*SMALL, word])
    told = f"{name} {value}"
    assert told in describe_origin(config)  # type: ignore[arg-type]
    assert list_origin(config)[name] == value  # type: ignore[arg-type]
    assert told in list_common_facts([config])  # type: ignore[list-item]


def test_sensors_without_faults_are_told_without_them() -> None:
    config = compose(list(SMALL))
    named = {name for name, _ in FAULTS.values()}
    assert not named & set(list_sensors(config.sensors))  # type: ignore[attr-defined]
    assert not any(name in describe_origin(config) for name in named)  # type: ignore[arg-type]


def test_the_structures_own_tilt_is_told_in_words() -> None:
    config = compose(["motion=plant", "sensors.imu.tilt=structure"])
    assert "IMU tilt that of the structure" in describe_origin(config)  # type: ignore[arg-type]
