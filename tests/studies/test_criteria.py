"""The criteria of a declared study stand in its measures; the key `criterion` takes their names."""

from __future__ import annotations

from typing import get_args

import pytest

from owtsweep.studies import get_study


@pytest.mark.parametrize("name", ["blade", "floater", "mating", "tower"])
def test_the_key_takes_every_criterion_and_no_other(name: str) -> None:
    study = get_study(name)
    taken = get_args(study.config_type().model_fields["criterion"].annotation)
    assert sorted(taken) == sorted(study.contest().criteria)
