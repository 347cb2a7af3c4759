"""The real records beside the repository, where they are there."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from owtsweep.motion.recorded import describe, read, to_grid, to_motion
from owtsweep.motion.whittle import fit

BESIDE = Path(__file__).parents[4] / "shared" / "data"
DATA = Path(os.environ.get("OWTSWEEP_DATA", BESIDE))
pytestmark = pytest.mark.skipif(
    not DATA.is_dir(), reason=f"no folder of real records: set OWTSWEEP_DATA, or make {DATA}"
)


def test_the_fast_record_of_the_monopile() -> None:
    path = DATA / "oc3_monopile_FAST_Test19.outb"
    recording = read(path)
    assert recording.names["position_x"] == "TwHt1TPxi"
    assert len(recording.time) == 1201
    assert recording.rate("position_x") == pytest.approx(20.0)
    (note,) = recording.notes
    assert "a gauge at a height on the tower" in note
    text = describe(path)
    assert "54 channels" in text
    assert text.index("TwHt1TPxi") < text.index("Wave1Elev") < text.index("GenPwr")


def test_both_monopile_records_have_the_tower_at_0_28_hz() -> None:
    """Two peaks, wave and tower: a fit over the whole band says so, one around the tower holds."""
    for name in ("oc3_monopile_FAST_Test19.outb", "oc3_monopile_towertop.csv.gz"):
        motion = to_motion(read(DATA / name), 100.0)
        both = motion.pairs["position"].T
        assert any("one peak" in text for text in fit(both, 0.01).warnings)
        tower = fit(both, 0.01, band=(0.18, 0.6))
        assert not tower.warnings
        assert abs(tower.natural_period - 1 / 0.28) < 3 * tower.errors["natural_period"]


def test_force_and_optical_position_of_the_hand_held_sensor_agree() -> None:
    """Specific force less its mean is the second derivative of the optical position."""
    recording = read(DATA / "broad10_imu_optical.csv.gz")
    reference = to_motion(recording, 100.0, quantity="reference", cutoff=3.0)
    for i, axis in enumerate("xy"):
        derived = reference.pairs["acceleration"][:, i]
        force = to_grid(recording, f"specific_force_{axis}", reference.grid)
        both = np.isfinite(derived)
        pair = np.corrcoef(derived[both], force[both])
        assert pair[0, 1] > 0.9
