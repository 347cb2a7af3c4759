"""The configuration that --cfg prints: units in comments, and the data of config.yaml."""

from __future__ import annotations

import pytest
import yaml

from owtsweep.config import dump, dump_with_units
from owtsweep.studies import compose


@pytest.mark.parametrize("words", [["tuning=[paper,matched]"], ["tuning=matched"]])
def test_units_stand_behind_keys_and_the_data_stay(words):
    config = compose(words)
    text = dump_with_units(config)
    assert yaml.safe_load(text) == yaml.safe_load(dump(config))
    lines = [line.strip() for line in text.splitlines()]
    assert {"natural_period:  # s", "delay: 0.2  # s", "gravity:  # m/s^2"} <= set(lines)
    assert sum(line.startswith("q_a: ") for line in lines) == sum(
        line.endswith(("# (m/s^3)^2/Hz", "# (m/s^2)^2/Hz")) for line in lines
    )
    assert "replicates: auto" in lines
