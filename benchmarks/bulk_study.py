"""A study whose blocks cost nothing to compute, so that a sweep consists of bookkeeping."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from owtsweep.config import Compute, Config, Section, key
from owtsweep.sweep.study import OK, Block, Engine, Study

SCHEMES = ("A", "B", "C", "D")


class BulkGrid(Section):
    """The section `grid`: the number of cases, which four schemes share evenly."""

    cases: int = key("in all", default=0)
    per_block: int = key("in a block", default=80)


class BulkConfig(Config):
    """The configuration of the study."""

    study: str = key("which study it is", default="bulk")
    experiment: str = key("begins the name of the run folder", default="bulk")
    grid: BulkGrid = key("how many cases", default=BulkGrid())


class BulkStudy(Study, Engine):
    """The study and its engine: the value of a case is a known function of the case's number."""

    name = "bulk"
    schema_version = 1
    numerics_version = 1
    samples = True

    def config_type(self) -> type[Config]:
        return BulkConfig

    def conditions(self, config: BulkConfig) -> tuple[()]:
        return ()

    def engine(self, config: BulkConfig) -> BulkStudy:
        return self

    def plan(self, config: BulkConfig) -> list[Block]:
        """Return the blocks: in each group one block per scheme, as in the hub study."""
        each = config.grid.cases // len(SCHEMES)
        return [
            Block(
                group=f"{first}",
                label=f"{scheme}, from {first}",
                content={
                    "seed": config.seed,
                    "scheme": scheme,
                    "first": first,
                    "last": min(first + config.grid.per_block, each),
                },
                cases=min(config.grid.per_block, each - first),
            )
            for first in range(0, each, config.grid.per_block)
            for scheme in SCHEMES
        ]

    def backend(self, config: BulkConfig) -> str:
        return "threading"

    def run(
        self, config: BulkConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        for block in blocks:
            content = block.content
            replicate = np.arange(content["first"], content["last"])
            table = {
                "scheme": content["scheme"],
                "replicate": replicate,
                "value": value(content["scheme"], replicate),
                "status": OK,
                "reason": "",
            }
            yield block, pd.DataFrame(table)

    def sort_columns(self) -> list[str]:
        return ["scheme", "replicate"]

    def tables(self, config: BulkConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Make the table "summary": the exact sum of each scheme's values, and their number."""
        groups = rows.groupby("scheme", as_index=False, observed=True)["value"]
        return {"summary": groups.agg(["sum", "count"])}

    def overview(self, config: BulkConfig) -> str:
        return "none"

    def terminal(self, config: Any, tables: Any) -> Any:
        return ""

    def drawings(self, *arguments: Any) -> dict[str, Any]:
        return {}


def value(scheme: str, replicate: np.ndarray) -> np.ndarray:
    """Return the values of cases: whole numbers below 2^16, so that sums are exact in any order."""
    return ((replicate * 2654435761 + SCHEMES.index(scheme) * 40503) % 65536).astype(float)


def bulk_config(results: Path, cases: int, per_block: int, workers: int = 2) -> BulkConfig:
    """Make the configuration of a study of `cases` cases, with runs in the folder `results`."""
    return BulkConfig(
        results=str(results),
        grid=BulkGrid(cases=cases, per_block=per_block),
        compute=Compute(workers=workers),
    )
