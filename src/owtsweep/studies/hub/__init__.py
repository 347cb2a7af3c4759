"""The hub-motion study: the sensitivity study of Ren et al. (2019), sections 5.3-5.4."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.comparison import Comparison, Findings

__all__ = ["HubStudy"]

logger = logging.getLogger(__name__)


class HubStudy:
    """`owtsweep.sweep.study.Study` for the hub motion; heavy imports wait for their use."""

    name = "hub"
    schema_version = 1
    numerics_version = 4

    def schemes(self) -> dict[str, str]:
        """Its schemes and what each is."""
        from owtsweep.studies.hub.schemes import REGISTERED

        return {name: purpose for name, (_, purpose) in REGISTERED.items()}

    def config_type(self) -> type[HubConfig]:
        """The study's configuration."""
        from owtsweep.studies.hub.config import HubConfig

        return HubConfig

    def plan(self, config: HubConfig) -> list[Block]:
        """One block per period, run of 8 replicates and scheme; without records, per scheme."""
        if config.engine == "expected":
            from owtsweep.studies.hub.expected import engine

            return engine.plan(config)
        from owtsweep.studies.hub import blocks

        return blocks.plan(config)

    def backend(self, config: HubConfig) -> str:
        """Threads for kernels, which release the GIL; processes as soon as one scheme is Python."""
        if config.engine == "expected":
            return "threading"
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
        if config.engine == "expected":
            from owtsweep.studies.hub.expected import engine

            return engine.run(config, blocks)
        from owtsweep.studies.hub.blocks import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        """What identifies a row."""
        return ["natural_period", "scheme", "measure", "window", "amplitude", "replicate"]

    def aggregate(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """summary and best_scheme."""
        if config.engine == "expected":
            from owtsweep.studies.hub.expected import answers

            return answers.tables(config, rows)
        from owtsweep.results import aggregate
        from owtsweep.results.cube import Cube

        names = scheme_names(config)
        cube = Cube.of_rows(rows, names, config.grid.amplitude)
        return {
            "summary": aggregate.summary(cube, names),
            "best_scheme": aggregate.best_scheme(
                cube, names, config.measures.window, criteria=criteria(config)
            ),
        }

    def terminal(self, config: HubConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """The map as a coloured grid."""
        from owtsweep.figures.terminal import grid

        return grid(
            tables["best_scheme"],
            scheme_names(config),
            config.measures.criterion,
            config.measures.window,
        )

    def overview(self) -> str:
        """The map, figure 18."""
        from owtsweep.studies.hub.figures import MAP

        return MAP

    def draw(
        self,
        config: HubConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        folder: Path,
        *,
        only: str | None = None,
        metadata: Mapping[str, str] | None = None,
    ) -> list[Path]:
        """All figures and tables of the paper that the run has the data for."""
        if config.engine == "expected":
            from owtsweep.studies.hub.expected import drawing

            return drawing.draw_all(config, tables, rows, folder, only=only, metadata=metadata)
        from owtsweep.studies.hub.figures import draw_all

        return draw_all(config, tables, rows, folder, only=only, metadata=metadata)

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """How map, boundary and errors move between runs."""
        from owtsweep.comparing import compare

        return compare(comparison, folder, metadata=metadata)


def criteria(config: HubConfig) -> tuple[str, ...]:
    """What best_scheme.csv judges: position and velocity, and the config's own if it is another."""
    return tuple(dict.fromkeys(("position", "velocity", config.measures.criterion)))


def scheme_names(config: Any) -> list[str]:
    """The names of a run's schemes in their order."""
    from owtsweep.studies.hub.schemes import resolve_all

    return [scheme.name for scheme in resolve_all(config.schemes)]
