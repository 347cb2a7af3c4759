"""What a replay says of an IMU that leans with the tower."""

import pytest

from owtsweep.studies.replay.describe import describe_tilt
from owtsweep.studies.replay.facts import measure_record
from owtsweep.studies.replay.files import MOTION, write_sample
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.running import configure

pytestmark = pytest.mark.usefixtures("kernels")


def tell(tmp_path, tilt: float) -> str:
    """Return what is said of a tilt, rad/m, for the sample motion."""
    write_sample(tmp_path)
    words = ["schemes=[HME1]", f"sensors.imu.tilt={tilt}"]
    config = configure([str(tmp_path / MOTION)], words)
    found = measure_record(config, load_record(config, config.grid.files[0]))
    return describe_tilt(config, {name: value for name, _, value, _ in found})


@pytest.mark.parametrize(
    ("tilt", "words"),
    [
        (0.15, "it matters, so let the filters know it"),
        (0.0137, "it does not matter at this period and size"),
    ],
)
def test_the_report_says_what_a_stated_tilt_costs(tmp_path, tilt, words):
    said = tell(tmp_path, tilt)
    assert f"a tilt of {tilt:g} rad/m is" in said
    assert words in said


def test_no_tilt_is_not_spoken_of(tmp_path):
    assert tell(tmp_path, 0.0) == ""
