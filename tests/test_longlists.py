"""Long lists of numbers go past Hydra and YAML, and nobody sees it."""

import dataclasses

import numpy as np
import pytest
from omegaconf import OmegaConf

from owtsweep import config, longlists
from owtsweep.errors import InputError

RANDOM = np.random.default_rng(5)
LISTS = [
    [0.01 * (i + 1) for i in range(200)],
    [*range(1, 60)],
    [float(x) for x in RANDOM.lognormal(0.0, 1.0, 50)],
    [float(x) for x in RANDOM.lognormal(0.0, 9.0, 50)],  # some with exponents
    [0.5, *range(1, 40), 0.25],
    [*(0.5 + i for i in range(40)), 1e-07],  # YAML writes 1.0e-07
    [*(0.5 + i for i in range(40)), 1e22],
]


def outcome(overrides):
    try:
        return config.compose(overrides)
    except InputError as error:
        return str(error)


def text(numbers):
    return "grid.amplitude=[" + ", ".join(map(repr, numbers)) + "]"


@pytest.mark.parametrize(
    "overrides",
    [
        *([text(numbers)] for numbers in LISTS),
        [text(LISTS[0]), "grid.amplitude=[1.0]"],
        [text(LISTS[0]), text(LISTS[1]), "grid.natural_period=${grid.amplitude}"],
        [text(LISTS[0]), "grid.amplitude.0=7.0"],
        [text(LISTS[0]), "name=run-${grid.amplitude}"],
        ["grid.amplitud=" + text(LISTS[1]).split("=")[1]],
        ["+grid.amplitude=" + text(LISTS[1]).split("=")[1]],
        ["record.duration=" + text(LISTS[1]).split("=")[1]],
        ["grid.replicates=" + text(LISTS[1]).split("=")[1]],
        [text([*LISTS[0], -1.0])],
        [text([*LISTS[0], 007.5]).replace("7.5", "007.5")],
        [text(LISTS[0]).replace("]", ", nan]")],
        [text(LISTS[0]).replace("]", ", 1_000]")],
    ],
)
def test_a_long_list_composes_as_hydra_composes_it(overrides, monkeypatch):
    found = outcome(overrides)
    monkeypatch.setattr(longlists, "LONG", 10**9)
    expected = outcome(overrides)
    assert repr(found) == repr(expected)  # types and bits


def test_a_long_list_is_taken_past_hydra(monkeypatch):
    seen = []
    composed = config._composed
    monkeypatch.setattr(config, "_composed", lambda *a: (seen.append(a[1]), composed(*a))[1])
    config.compose([text(LISTS[0])])
    assert len(seen) == 1
    assert max(map(len, seen[0])) < 100


@pytest.mark.parametrize("numbers", LISTS)
def test_a_long_list_is_written_as_yaml_writes_it(numbers):
    whole = config.compose([])
    grid = dataclasses.replace(whole.grid, amplitude=[*map(float, numbers)])
    changed = dataclasses.replace(whole, grid=grid, schemes=[{"_target_": "a.B", "x": LISTS[2]}])
    plain = OmegaConf.create(config._plain(dataclasses.asdict(changed)))
    assert config.dump(changed) == OmegaConf.to_yaml(plain)
