"""A study is planned again with more records of some cells."""

from __future__ import annotations

from typing import Any

import pandas as pd

from owtsweep.studies import compose, get_study
from owtsweep.studies.base.blocks import PlanPart
from owtsweep.sweep.keys import block_key

WORDS = [
    "study=floater", "record.duration=60", "record.rate=10", "record.settling=20",
    "grid.delay=[0,2]", "grid.bias=[0.1]", "grid.replicates=10", "schemes=[LOWPASS,KF]",
]  # fmt: skip
STUDY = get_study("floater")


def list_keys(blocks: list[Any]) -> list[str]:
    return [block_key(STUDY, block) for block in blocks]


def test_more_records_of_a_cell_add_only_the_missing_blocks() -> None:
    config: Any = compose(WORDS)
    engine: Any = STUDY.engine(config)
    cells = engine.contest.list_cells(config)
    first = engine.plan(config)
    assert list_keys(engine.plan(config, PlanPart(cells, 10))) == list_keys(first)
    more = engine.plan(config, PlanPart(cells[1:], 30))
    kept = set(list_keys(first))
    added = [block for block in more if block_key(STUDY, block) not in kept]
    assert len(more) == len(added) + len(first) // 2
    told = [(b.content["delay"], b.content["scheme"], b.content["replicates"]) for b in added]
    assert told == [(2.0, name, [n, n + 10]) for n in (10, 20) for name in ("LOWPASS", "KF")]


def test_a_single_cell_has_small_blocks_for_several_cores() -> None:
    config: Any = compose([*WORDS, "grid.delay=[0]", "grid.replicates=5"])
    blocks = STUDY.engine(config).plan(config)
    assert [b.content["replicates"] for b in blocks[::2]] == [[0, 2], [2, 4], [4, 5]]
    assert len({block.group for block in blocks}) == 3


def test_tables_and_maps_are_made_of_cells_with_unequal_numbers_of_records() -> None:
    config: Any = compose([*WORDS, "grid.replicates=2"])
    engine: Any = STUDY.engine(config)
    cells = engine.contest.list_cells(config)
    blocks = [
        *engine.plan(config, PlanPart(cells[:1], 2)),
        *engine.plan(config, PlanPart(cells[1:], 4)),
    ]
    rows = pd.concat([
        rows for block in blocks for _, rows in engine.run(config, [block])
    ], ignore_index=True)  # fmt: skip
    tables = engine.tables(config, rows)
    summary = tables["summary"].query("measure == 'velocity'")
    assert summary.groupby("delay")["n"].unique().map(list).to_dict() == {0.0: [2], 2.0: [4]}
    assert len(tables["best_scheme"].query("criterion == 'velocity'")) == 2
    assert "map_velocity" in engine.drawings(config, tables, rows, {})


def test_the_hub_plans_more_records_of_a_cell_too() -> None:
    """Linear schemes have one block for all amplitudes; MHE with constraints one for each."""
    study = get_study("hub")
    config: Any = compose([
        "tuning=paper", "grid.natural_period=[4,8]", "grid.amplitude=[0.1,1]", "grid.replicates=8",
        "schemes=[MKF,HME2]", "baselines=[]", "hme.mhe.constraints.bias=1",
    ])  # fmt: skip
    engine: Any = study.engine(config)
    cells = engine.declaration.axes.list_cells(config)
    first = engine.plan(config)
    assert len(cells) == 4
    assert len(first) == 2 * (1 + 2)
    kept = {block_key(study, block) for block in first}
    more = [
        block
        for block in engine.plan(config, PlanPart(cells[2:3], 16))
        if block_key(study, block) not in kept
    ]
    told = [
        (b.content["scheme"], b.content.get("amplitude"), b.content["replicates"]) for b in more
    ]
    assert told == [("MKF", None, [8, 16]), ("HME2", 0.1, [8, 16])]
