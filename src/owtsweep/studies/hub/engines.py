"""The hub study's engines: from records, step by step or by kernels, and without any record."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from owtsweep.studies.hub import criteria, scheme_names

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.figures.drawings import Drawing
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.study import Block, Engine

logger = logging.getLogger(__name__)


class _Engine:
    """What both engines share: how rows are told apart, and the map as their answer."""

    def sort_columns(self) -> list[str]:
        """What identifies a row."""
        return ["natural_period", "scheme", "measure", "window", "amplitude", "replicate"]

    def terminal(self, config: HubConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """The map as a coloured grid."""
        from owtsweep.figures.terminal import grid
        from owtsweep.studies.hub.conditions import CONDITIONS

        return grid(
            tables["best_scheme"],
            scheme_names(config),
            CONDITIONS,
            config.measures.criterion,
            config.measures.window,
        )

    def overview(self, config: HubConfig) -> str:
        """The map, figure 18."""
        from owtsweep.studies.hub.figures import MAP

        return MAP


class RecordsEngine(_Engine):
    """`engine: batch` and `engine: reference`: simulated records through estimators."""

    samples = True

    def plan(self, config: HubConfig) -> list[Block]:
        """One block per period, run of 8 replicates and scheme."""
        from owtsweep.studies.hub import blocks

        return blocks.plan(config)

    def backend(self, config: HubConfig) -> str:
        """Threads for kernels, which release the GIL; processes as soon as one scheme is Python."""
        from owtsweep.studies.hub import blocks
        from owtsweep.studies.hub.schemes import resolve_all

        schemes = resolve_all(config.schemes, config)
        for scheme in schemes:
            if config.engine == "batch" and getattr(scheme, "constrained", False):
                logger.warning(
                    "%s: its constraints leave no kernel that serves all amplitudes; it runs step "
                    "by step, amplitude by amplitude",
                    scheme.name,
                )
        return blocks.backend(config, schemes)

    def run(
        self, config: HubConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group."""
        from owtsweep.studies.hub.blocks import run

        return run(config, blocks)

    def tables(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """summary and best_scheme, with intervals over the records."""
        from owtsweep.results.best_scheme import find_best_schemes
        from owtsweep.results.summary import summarise
        from owtsweep.studies.hub.conditions import make_cube

        cube = make_cube(config, rows)
        best = find_best_schemes(cube, config.measures.window, criteria(config))
        return {"summary": summarise(cube), "best_scheme": best}

    def drawings(
        self,
        config: HubConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """All figures and tables of the paper."""
        from owtsweep.studies.hub.figures import drawings

        return drawings(config, tables, rows, metadata)


class ExpectedEngine(_Engine):
    """`engine: expected`: the expectation over all records, from the schemes' error spectra."""

    samples = False

    def plan(self, config: HubConfig) -> list[Block]:
        """One block per scheme."""
        from owtsweep.studies.hub.expected import engine

        return engine.plan(config)

    def backend(self, config: HubConfig) -> str:
        """Threads: all that takes time are kernels."""
        return "threading"

    def run(
        self, config: HubConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Compute the blocks, one scheme each."""
        from owtsweep.studies.hub.expected import engine

        return engine.run(config, blocks)

    def tables(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """summary and best_scheme, without intervals."""
        from owtsweep.studies.hub.expected import answers

        return answers.tables(config, rows)

    def drawings(
        self,
        config: HubConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """The maps, MSE over amplitude and the error spectra."""
        from owtsweep.studies.hub.expected.drawing import drawings

        return drawings(config, tables, rows, metadata)


#: The key `engine` -> what makes the engine.
ENGINES: dict[str, Callable[[], Engine]] = {
    "batch": RecordsEngine,
    "reference": RecordsEngine,
    "expected": ExpectedEngine,
}
