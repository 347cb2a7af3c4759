"""The rows of the compiled kernels are those of running each scheme and scoring its estimates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from tools import configure

from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.engines import find_declaration

PRODUCTS = ["motion", "cross", "noise", "value"]
ALL = ("schemes=[EKF,MKF,HME1,HME2]", "baselines=[NONE,HOLD,DELTA]")
DIRECT = (*ALL, "evaluation=direct", "measures.extremes=true")
OWN = ("schemes=[SKF,SKFA]", "record.duration=40", "grid.amplitude=[0.7]")


def make_rows(declaration: AnyDeclaration, config: HubConfig) -> pd.DataFrame:
    blocks = DeclaredBlocks(declaration)
    plan = blocks.plan(config)
    rows = [
        table
        for group in dict.fromkeys(block.group for block in plan)
        for _, table in blocks.run(config, [block for block in plan if block.group == group])
    ]
    labels = ["scheme", "replicate", "amplitude", "measure", "window"]
    return pd.concat(rows).sort_values(labels, ignore_index=True)


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize(
    ("words", "tuning"),
    [
        (ALL, "paper"),
        (ALL, "matched"),
        (DIRECT, "paper"),
        (DIRECT, "matched"),
        (OWN, "matched"),  # SKF and SKFA have no tuning
    ],
)
def test_kernels_give_the_rows_of_run_and_score(words: tuple[str, ...], tuning: str) -> None:
    config = configure(*words, "grid.replicates=2", tuning=tuning)
    declaration = find_declaration(config)
    batched = make_rows(declaration, config)
    stepped = make_rows(replace(declaration, batch=None), config)
    labels = [name for name in batched if name not in PRODUCTS]
    pd.testing.assert_frame_equal(batched[labels], stepped[labels])
    assert set(batched["status"]) == {"ok"}
    errors = batched[PRODUCTS].abs()
    largest = errors.groupby([batched["scheme"], batched["measure"]]).transform("max").max(axis=1)
    for name in PRODUCTS:
        there = batched[name].notna()
        assert (there == stepped[name].notna()).all()
        difference = (batched[name] - stepped[name]).abs()[there]
        assert np.all(difference <= 1e-9 * largest[there]), name
