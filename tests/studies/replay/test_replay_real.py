"""The recorded files, where they are: the OC3 monopile and a hand-held IMU with optical truth."""

from __future__ import annotations

import pandas as pd
import pytest
from replay_tools import DATA, needs_data

from owtsweep.studies.replay.running import configure, execute

pytestmark = needs_data


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def table(name: str, *overrides: str) -> pd.Series:
    outcome = execute(configure([str(DATA / name)], list(overrides)))
    assert not outcome.failed
    return outcome.run.table("replay").set_index(["scheme", "measure", "window"])["value"]


def test_a_real_imu():
    """HME1's settled MSE, absolute and against holding the last fix: the bounds of the issue."""
    values = table("broad10_imu_optical.csv.gz", "schemes=[HME1]")
    mse = values["HME1", "position", "settled"]
    assert mse < 3.2e-3
    assert values["last_fix", "position", "settled"] / mse > 15.0


@pytest.mark.parametrize("name", ["oc3_monopile_FAST_Test19.outb", "oc3_monopile_towertop.csv.gz"])
def test_the_oc3_monopile(name):
    values = table(name, "schemes=[MKF,HME1]", "replay.replicates=4")
    for scheme in ("MKF", "HME1"):
        assert values[scheme, "position", "settled"] < values["last_fix", "position", "settled"]
    assert 0.9 < values["HME1", "coverage_position", "settled"] < 0.99
