"""A floating record: the motion that is composed, what is said of it, and its name in the store."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from replay_tools import config_of, write_csv

from owtsweep.config import with_values
from owtsweep.errors import InputError
from owtsweep.studies import get_study
from owtsweep.studies.replay.blocks import plan
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.loading import load_record
from owtsweep.sweep.keys import block_key, run_hash

TIME = np.arange(0.0, 60.0, 0.1)
SURGE, PITCH = 2.0 * np.sin(0.5 * TIME), 0.03 * np.cos(0.6 * TIME)
BEND = 0.1 * np.sin(2.0 * TIME)


@pytest.fixture(scope="module")
def base() -> ReplayConfig:
    """A replay's configuration, composed only once."""
    return config_of([], "sensors.imu.rate=10", "sensors.gnss.rate=10", "replay.remove_mean=false")


def of(base: ReplayConfig, file: Path, **columns: Any) -> ReplayConfig:
    """The configuration for a file, with some keys of `columns`."""
    keys = {f"columns.{name}": value for name, value in columns.items()}
    return with_values(base, {"grid.files": [str(file)], **keys})


def floating(path: Path, **more: np.ndarray) -> Path:
    table = {"Time": TIME, "TTDspFA": BEND, "PtfmSurge": SURGE, "PtfmPitch": np.rad2deg(PITCH)}
    return write_csv(path, {**table, **more})


def test_the_record_is_the_composed_motion_and_says_so(tmp_path, base):
    file = floating(tmp_path / "a.csv")
    record = load_record(of(base, file, tower_height=80.0), str(file))
    truth = SURGE + 80 * np.sin(PITCH) + BEND * np.cos(PITCH)
    expected = np.interp(record.time_at(slice(None)), TIME, truth)
    inner = slice(50, -50)
    assert np.std((record.position[:, 0] - expected)[inner]) < 1e-3 * np.std(truth)
    assert any("motion of the hub composed: x = PtfmSurge" in note for note in record.notes)
    with pytest.raises(InputError, match=r"columns\.tower_height"):
        load_record(of(base, file), str(file))


def test_other_motions_have_other_names_in_the_store(tmp_path, base):
    file = floating(tmp_path / "a.csv")
    told = ({}, {"motion": "tower"}, {"tower_height": 80.0}, {"tower_height": 81.0})
    configs = [of(base, file, **some) for some in told]
    assert len({run_hash(config) for config in configs}) == 4
    keys = {block_key(get_study("replay"), plan(config)[0]) for config in configs}
    assert len(keys) == 4


def test_sensors_do_without_a_reference_that_would_need_a_height(tmp_path, base):
    file = floating(tmp_path / "a.csv", acc_x=BEND, fix_x=SURGE)
    record = load_record(of(base, file), str(file))
    assert record.position is None
    assert any("columns.tower_height" in note for note in record.notes)
    assert load_record(of(base, file, tower_height=80.0), str(file)).position is not None
