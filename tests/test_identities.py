"""Stored configurations keep their names: run hashes, block keys and plans of before.

`fixtures/identities/` was written by the last commit before the rooms were rebuilt: resolved
configurations (`<case>.yaml`) and what identified them then (`identities.json`).
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from hashlib import blake2b
from pathlib import Path

import pytest
from omegaconf import OmegaConf

from owtsweep.config import Config, changed, dump
from owtsweep.studies import compose, from_mapping, get_study
from owtsweep.studies.opening import load_config
from owtsweep.studies.replay.running import configure
from owtsweep.sweep.keys import run_folder, run_hash
from owtsweep.sweep.plan import make_plan

FOLDER = Path(__file__).parent / "fixtures/identities"
EXPECTED = json.loads((FOLDER / "identities.json").read_text())

#: The overrides that each stored configuration was composed from. `experiment=study` and
#: `tuning=paper` were the defaults.
OVERRIDES = {
    "default": [],
    "paper": ["experiment=paper", "tuning=paper"],
    "matched": ["tuning=matched"],
    "matched_on_paper": ["experiment=paper", "tuning=matched"],
    "printed_tuning": ["tuning=printed"],
    "printed_spectrum": ["spectrum=printed", "grid.natural_period=[6.0,7.0,8.0]"],
    "small": ["grid=small"],
    "tables": ["grid=tables", "grid.replicates=3"],
    "single": ["compute=single", "seed=7"],
    "reference": ["engine=reference", "grid=small"],
    "expected": ["engine=expected"],
    "expected_rms": ["engine=expected", "normalise=rms", "tuning=matched"],
    "direct": ["evaluation=direct", "grid=small", "measures.extremes=true"],
    "constrained": ["hme.mhe.constraints.bias=0.3", "grid=small", "tuning=matched"],
    "bounded": [
        "hme.mhe.constraints.position=5.0", "hme.mhe.constraints.velocity=4.0", "schemes=[HME2]",
    ],
    "sensors": [
        "sensors.gnss.rate=5", "sensors.gnss.delay=0.1", "sensors.imu.rate=50", "sensors.yaw=12.5",
    ],
    "accuracy": ["sensors.accuracy=bound", "sensors.gravity=[0.1,-0.2]", "wave_direction=0"],
    "ablation": ["experiment=paper", "schemes=[HME1,HME2]", "hme.mhe.inputs=all"],
    "measures": [
        "measures.window=settled", "measures.criterion=velocity", "measures.settling_time=30",
    ],
    "user_scheme": ["grid=small", "schemes=[MKF,{_target_:hold_last_fix.HoldLastFix}]"],
    "readings": ["experiment=readings"],
    "readings_small": [
        "experiment=readings", "calibration.trials=3", "calibration.sampler_seeds=[1,2]",
    ],
}  # fmt: skip
REPLAYS = {
    "replay_motion": ("motion.csv", []),
    "replay_sensors": (
        "sensors.csv",
        ["replay.band=[0.1,0.5]", "measures.settling_time=2", "columns.position_x=null"],
    ),
    "replay_many": (
        "*.csv",
        ["tuning=paper", "replay.replicates=3", "gaps=interpolate", "units.position_x=mm"],
    ),
}


@pytest.fixture(autouse=True)
def _where_they_were_written(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The replays name their files relatively; the user's scheme lies among the hub's tests."""
    monkeypatch.syspath_prepend(str(FOLDER.parents[1] / "hub"))
    before = os.getcwd()
    os.chdir(FOLDER)
    yield
    os.chdir(before)


@pytest.mark.parametrize("name", EXPECTED)
def test_a_stored_configuration_keeps_its_hash_and_its_blocks(name: str) -> None:
    # As this user's own configuration: a stored one of another's is read without their scheme.
    config = from_mapping(OmegaConf.load(FOLDER / f"{name}.yaml"))
    plan = make_plan(get_study(config.study), config)
    lines = (f"{k} {b.group} | {b.label} | {b.cases} | {b.cases_per_row}" for k, b in plan.items())
    assert EXPECTED[name] == {
        "run_hash": run_hash(config),
        # Since then, the folder of a single record has a digest of the record in its name.
        "run_folder": re.sub(r"-[0-9a-f]{8}(?=-[0-9a-f]{10}$)", "", run_folder(config).name),
        "blocks": len(plan),
        "first_block": next(iter(plan)),
        "plan": blake2b("\n".join(lines).encode(), digest_size=16).hexdigest(),
    }
    assert_same_text(config, name)


def assert_same_text(config: Config, name: str) -> None:
    """config.yaml has the stored lines in their order; only keys younger than them add some."""
    stored = (FOLDER / f"{name}.yaml").read_text().splitlines()
    lines = iter(dump(config).splitlines())
    assert [line for line in stored if line not in lines] == []
    assert dump(config) == dump(load_config(FOLDER / f"{name}.yaml"))


@pytest.mark.parametrize("name", OVERRIDES)
def test_the_same_overrides_give_the_same_configuration(name: str) -> None:
    words = OVERRIDES[name]
    given = {word.partition("=")[0] for word in words}
    # the defaults of the commit that wrote the fixtures
    before = [
        word for word in ("experiment=study", "tuning=paper") if word.partition("=")[0] not in given
    ]
    # A stored run has no baselines; a new one has them by default.
    assert_same_text(changed(compose([*before, *words]), baselines=[]), name)


@pytest.mark.parametrize("name", REPLAYS)
def test_the_same_replay_gives_the_same_configuration(name: str) -> None:
    file, overrides = REPLAYS[name]
    # A stored replay held the force over a step; a new one takes it as linear by default.
    config = configure([file], [*overrides, "hme.predictor.hold=zero"])
    grid = changed(config.grid, files=[Path(path).name for path in config.grid.files])
    assert_same_text(changed(config, grid=grid), name)


def test_every_stored_configuration_is_composed_again() -> None:
    assert {*OVERRIDES, *REPLAYS} == set(EXPECTED)
