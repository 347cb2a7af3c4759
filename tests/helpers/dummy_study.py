"""A study without physics: deterministic rows, and faults on demand.

A module of its own, because worker processes import it by its name, and there is more than one
conftest.
"""

from __future__ import annotations

import atexit
import logging
import os
import signal
import sys
import threading
import time
import warnings
from asyncio import CancelledError
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from owtsweep.config import Axis, Compute, Config, Section, changed, key, typed
from owtsweep.figures.drawings import Drawing
from owtsweep.io.tables import write_table
from owtsweep.results.conditions import Condition
from owtsweep.results.status import FAILED, OK, UNABLE
from owtsweep.sweep.study import Block, Engine, Study


class DummyGrid(Section):
    level: Axis[float] = key("a level", default=[1.0, 2.0, 0.3])


class DummyConfig(Config):
    study: str = key("which study it is", default="dummy")
    experiment: str = key("begins the name of the run folder", default="test")
    sigma: float = key("factor of the values", default=0.1)
    grid: DummyGrid = key("the axis", default=DummyGrid())
    schemes: list[str] = key("letters", default=["A", "B"])


#: Fault -> what it raises, which is no `Exception`.
BASE = {error.__name__: error for error in (KeyboardInterrupt, GeneratorExit, CancelledError)}
#: Fault -> status and reason of its two rows.
ROWS = {
    "": ((OK, ""), (OK, "")),
    "case": ((OK, ""), (FAILED, "it diverged")),
    "cases": ((FAILED, "it diverged"), (FAILED, "it diverged")),
    "unexplained": ((FAILED, None), (FAILED, None)),
    "unable": ((OK, ""), (UNABLE, "it is unstable")),
    "blind": ((UNABLE, "it is blind"), (UNABLE, "it is blind")),
    "torn": ((FAILED, "it diverged"), (UNABLE, "it is unstable")),
}


@dataclass
class DummyStudy(Study, Engine):
    """A study as small as can be, which is its own only engine; two cases per block.

    `faults` says at which block (by its label) what happens: "raise", "memory", "exit", "silent"
    (no rows), "statusless" (rows of the wrong shape), "interrupt" (Ctrl-C to the sweep), "kill"
    (the worker process dies), "thread" (one that never ends), "slow end" (of the worker
    process), "slow", "long" (a minute), "log", those of `BASE`, and those of `ROWS`, where cases
    have no number.
    """

    faults: Mapping[str, str] = field(default_factory=dict)
    parent: int = field(default_factory=os.getpid)
    name: str = "dummy"
    schema_version: int = 1
    numerics_version: int = 1
    pause: float = 0.0
    samples: bool = True

    def config_type(self) -> type[Config]:
        return DummyConfig

    def conditions(self, config: DummyConfig) -> tuple[Condition, ...]:
        return (Condition("level", "level", "m", in_streams=True),)

    def engine(self, config: DummyConfig) -> DummyStudy:
        return self

    def plan(self, config: DummyConfig) -> list[Block]:
        return [
            Block(
                group=f"{level}",
                label=f"{scheme}{level}",
                content={
                    "seed": config.seed,
                    "sigma": config.sigma,
                    "level": level,
                    "scheme": scheme,
                },
                cases=2,
            )
            for level in config.grid.level
            for scheme in config.schemes
        ]

    def backend(self, config: DummyConfig) -> str:
        return "threading"

    def run(
        self, config: DummyConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        for block in blocks:
            time.sleep(self.pause)
            fault = self.faults.get(block.label, "")
            if fault == "raise":
                raise ArithmeticError("no\n  convergence")
            if fault == "memory":
                raise MemoryError
            if fault == "exit":
                sys.exit("enough")
            if fault == "interrupt":
                os.kill(self.parent, signal.SIGINT)
            if fault in BASE:
                raise BASE[fault]
            if fault == "kill" and os.getpid() != self.parent:
                os.kill(os.getpid(), signal.SIGKILL)
            if fault == "thread":
                threading.Thread(target=threading.Event().wait, daemon=False).start()
            if fault == "slow end" and os.getpid() != self.parent:
                atexit.register(time.sleep, 60.0)
            if fault == "slow":
                time.sleep(0.1)
            if fault == "long":
                time.sleep(60.0)
            if fault == "log":
                logging.getLogger("owtsweep.dummy").info("at work")
                logging.getLogger("mine").warning("a user's word")
                warnings.warn("watch\nout", UserWarning, stacklevel=1)
            if fault == "statusless":
                yield block, self._rows(block, "").drop(columns="status")
            elif fault != "silent":
                yield block, self._rows(block, fault if fault in ROWS else "")

    def _rows(self, block: Block, fault: str) -> pd.DataFrame:
        content = block.content
        stream = np.random.SFC64(
            np.random.SeedSequence([content["seed"], int(content["level"] * 1000)])
        )
        return pd.DataFrame(
            {
                "level": content["level"],
                "scheme": content["scheme"],
                "replicate": [0, 1],
                "value": content["sigma"] * np.random.Generator(stream).standard_normal(2),
                "amplitude": np.nan,
                "status": [status for status, _ in ROWS[fault]],
                "reason": [reason for _, reason in ROWS[fault]],
            }
        )

    def sort_columns(self) -> list[str]:
        return ["level", "scheme", "replicate"]

    def tables(self, config: DummyConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        good = rows[rows["status"] == OK]
        means = good.groupby(["level", "scheme"], as_index=False)["value"].mean()
        return {
            "order": rows[self.sort_columns()],
            "summary": means.assign(
                third=means["value"] / 3.0, note=np.where(means["level"] == 1.0, "one", "")
            ),
        }

    def terminal(self, config: DummyConfig, tables: Mapping[str, pd.DataFrame]) -> str:
        return f"{len(tables['summary'])} means"

    def drawings(
        self,
        config: DummyConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        def means(folder: Path, name: str) -> list[Path]:
            return [write_table(folder, name, tables["summary"])]

        return {"means": means}

    def overview(self, config: DummyConfig) -> str:
        return "means"


def make_config(results: Path, **changes: Any) -> DummyConfig:
    """A configuration on one worker; `level`, `workers` and `backend` are short for their keys."""
    compute = {"workers": 1}
    compute |= {name: changes.pop(name) for name in [*Compute.model_fields] if name in changes}
    config = typed(DummyConfig, {"results": str(results), "compute": compute})
    if "level" in changes:
        changes["grid"] = changed(config.grid, level=changes.pop("level"))
    return changed(config, **changes)
