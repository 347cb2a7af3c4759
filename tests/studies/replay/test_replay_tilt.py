"""What a replay says of an IMU that leans with the tower."""

import pytest

import owtsweep
from owtsweep.studies.replay.describe import describe_tilt
from owtsweep.studies.replay.facts import pick_facts
from owtsweep.studies.replay.files import MOTION, write_sample

pytestmark = pytest.mark.usefixtures("kernels")
FEW = ["schemes=[HME1]", "replay.replicates=2", "replay.noise=stated"]


def tell(tmp_path, tilt: float) -> str:
    """Return what is said of a tilt, rad/m, for the sample motion."""
    write_sample(tmp_path)
    words = [*FEW, f"sensors.imu.tilt={tilt}", f"results={tmp_path}"]
    run = owtsweep.replay(tmp_path / MOTION, words).run
    return describe_tilt(run.config, pick_facts(run.table("records")))  # type: ignore[arg-type]


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
