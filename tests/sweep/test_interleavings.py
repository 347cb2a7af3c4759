"""However a run came about, its shards and tables are those of a run from scratch, bit for bit.

Hypothesis draws the life of a run: grids that grow and shrink, stops of every kind in between,
shards that get lost or damaged. The hub study's own life is in tests/studies/hub/test_resume.py.
"""

from __future__ import annotations

import tempfile
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import pandas as pd
from dummy_study import DummyStudy, make_config
from hypothesis import given, settings
from hypothesis import strategies as st

from owtsweep.config import Section, changed, key
from owtsweep.sweep.plan import make_plan
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import OK, Block


class Grid(Section):
    """What a life may change: `amplitude` stands in no block, like those of a linear scheme."""

    level: list[float] = key("a level")
    amplitude: list[float] = key("an amplitude")
    replicates: int = key("how many")


@dataclass
class GridStudy(DummyStudy):
    """Blocks of three replicates, the last one short; a fault is a block's label, as there."""

    faults: Any = field(default_factory=dict)

    def plan(self, config: Any) -> list[Block]:
        return [
            Block(
                group=f"{level}, {first}",
                label=f"{scheme}, {level}, {first}",
                content={
                    "seed": config.seed,
                    "level": level,
                    "scheme": scheme,
                    "replicates": list(range(first, min(first + 3, config.grid.replicates))),
                },
                cases=min(3, config.grid.replicates - first) * len(config.grid.amplitude),
                cases_per_row=len(config.grid.amplitude),
            )
            for level in config.grid.level
            for first in range(0, config.grid.replicates, 3)
            for scheme in config.schemes
        ]

    def _rows(self, block: Block, *reasons: str | None) -> pd.DataFrame:
        content = block.content
        values = [
            np.random.default_rng([content["seed"], int(content["level"] * 1000), replicate])
            .standard_normal(2)["AB".index(content["scheme"])]
            for replicate in content["replicates"]
        ]  # fmt: skip
        failed = [reasons[0] if reasons else ""] * len(values)
        return pd.DataFrame(
            {
                "level": content["level"],
                "scheme": content["scheme"],
                "replicate": content["replicates"],
                "value": values,
                "status": [OK if not reason else "failed" for reason in failed],
                "reason": failed,
            }
        )

    def aggregate(self, config: Any, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        good = rows[rows["status"] == OK]
        keys = ["level", "scheme"]
        means = good.groupby(keys, as_index=False, observed=True)["value"].mean()
        expanded = means.merge(pd.DataFrame({"amplitude": sorted(config.grid.amplitude)}), "cross")
        return {
            "order": rows[self.sort_columns()],
            "summary": expanded.assign(third=expanded["amplitude"] ** 2 * expanded["value"] / 3.0),
        }


class Step(NamedTuple):
    """One sweep of a life, and what befalls it.

    `stop`: Ctrl-C after so many reports, never if negative; `fault`: what happens in the block of
    this index; `lose`: shards that vanish or are damaged afterwards, by index.
    """

    config: Any
    workers: int
    stop: int
    fault: tuple[int, str]
    lose: list[tuple[int, str]]


class Stops(Progress):
    """An exception from the terminal's side after so many reports."""

    def __init__(self, reports: int) -> None:
        self.left = reports

    def advance(self, cases: int) -> None:
        if self.left == 0:
            raise KeyboardInterrupt
        self.left -= 1


def some(pool: list[Any]) -> st.SearchStrategy[list[Any]]:
    """Some of them, in any order."""
    return st.lists(st.sampled_from(pool), min_size=1, max_size=len(pool), unique=True)


CONFIGS = st.builds(
    lambda schemes, level, amplitude, replicates: changed(
        make_config(Path("unset")),
        schemes=schemes,
        grid=Grid(level=level, amplitude=amplitude, replicates=replicates),
    ),
    some([*"AB"]),
    some([1.0, 0.3]),
    some([0.1, 0.7, 10.0]),
    st.sampled_from([3, 5, 6]),
)
FAULTS = st.tuples(
    st.integers(0, 20), st.sampled_from(["", "", "raise", "exit", "silent", "cases"])
)
LOSSES = st.lists(st.tuples(st.integers(0, 20), st.sampled_from(["gone", "cut"])), max_size=2)
STEPS = st.builds(Step, CONFIGS, st.integers(1, 2), st.integers(-2, 5), FAULTS, LOSSES)


def live(step: Step, results: Path) -> None:
    """One sweep with what befalls it."""
    config = located(step.config, results, step.workers)
    index, kind = step.fault
    plan = GridStudy().plan(config)
    study = GridStudy({plan[index % len(plan)].label: kind})
    with suppress(KeyboardInterrupt):
        sweep(study, config, progress=Stops(step.stop))
    stored = sorted(results.glob("*/cases/part-*.parquet"))
    for place, loss in step.lose:
        if stored:
            path = stored[place % len(stored)]
            if loss == "gone":
                path.unlink(missing_ok=True)
            elif path.exists():
                path.write_bytes(path.read_bytes()[:-1])


def located(config: Any, results: Path, workers: int = 1) -> Any:
    return changed(config, results=str(results), compute=changed(config.compute, workers=workers))


def content(run: Run) -> dict[str, bytes]:
    """The bytes of all tables and of the shards of the plan."""
    keys = make_plan(run.study, run.config)
    paths = [*run.folder.glob("*.csv"), *(run.store.path(key) for key in keys)]
    return {path.name: path.read_bytes() for path in paths}


@settings(max_examples=20, deadline=None, derandomize=True, database=None)
@given(st.lists(STEPS, min_size=1, max_size=3), CONFIGS)
def test_every_life_of_a_run_ends_in_the_tables_of_a_run_from_scratch(
    steps: list[Step], last: Any
) -> None:
    # No power cut in here: waiting for the disk would be most of the time.
    with tempfile.TemporaryDirectory() as folder, patch("os.fsync"):
        lived, scratch = Path(folder) / "lived", Path(folder) / "scratch"
        for step in steps:
            live(step, lived)
        before = {path.name for path in lived.glob("*/cases/part-*.parquet")}
        end = sweep(GridStudy(), located(last, lived))
        fresh = sweep(GridStudy(), located(last, scratch))
        assert not end.failed
        assert end.computed + end.reused == fresh.computed
        assert content(end.run) == content(fresh.run)
        pd.testing.assert_frame_equal(end.run.cases(), fresh.run.cases(), check_exact=True)
        if not any(step.fault[1] or step.lose for step in steps):
            plan = make_plan(end.run.study, end.run.config)
            kept = [block for key, block in plan.items() if f"part-{key}.parquet" in before]
            assert end.reused == sum(block.cases for block in kept)
