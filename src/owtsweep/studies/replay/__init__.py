"""The study of records: run all schemes on recorded motion or sensor data; advise which to use."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.studies.hub.public import ROOMS, HubKeys
from owtsweep.sweep.asked import find_home
from owtsweep.sweep.study import FAILED, Block, Engine, add_versions

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from owtsweep.figures.drawings import Drawing
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.hub.public import HubConfig
    from owtsweep.studies.replay.config import ReplayConfig

__all__ = ["ReplayStudy"]

ESTIMATES = "estimates.parquet"
#: Figures that show a quantity over time; those ending in `_zoom` show some seconds only.
HISTORIES = (
    "position", "position_zoom", "velocity", "velocity_zoom", "acceleration_zoom", "bias",
)  # fmt: skip


class ReplayStudy(HubKeys, Engine):
    """The study of recorded data, which is also its only engine.

    A block runs one scheme on one record; a further block for each record measures the record
    itself.
    """

    name = "replay"
    numerics_version = add_versions(4, *ROOMS)
    samples = True
    #: Columns without which no table can be made.
    row_types: Mapping[str, type] = {
        **dict.fromkeys(("file", "scheme", "measure", "window"), str),
        **dict.fromkeys(("replicate", "value", "n_samples"), float),
    }

    def config_type(self) -> type[ReplayConfig]:
        from owtsweep.studies.replay.config import ReplayConfig

        return ReplayConfig

    def check(self, config: HubConfig) -> None:
        """Raise `InputError` if motion is not left to the record, or a scheme lacks knowledge."""
        from owtsweep.studies.hub.public import find_world, resolve_all

        require(
            find_world(config).has_spectrum,
            "motion: a replay takes its motion from the record; leave out "
            f"motion={config.motion.kind}",
        )
        known = None not in (config.skf.natural_period, config.skf.amplitude)
        for scheme in resolve_all(config.schemes):
            require(
                known or not (scheme.knows_motion and "skf" in scheme.sections),
                f"skf.natural_period, skf.amplitude: {scheme.name} must know the motion of the "
                "record; give the period of its peak and its amplitude, or leave "
                f"{scheme.name} out of schemes",
            )
        super().check(config)

    def describe_origin(self, config: HubConfig) -> str:
        return ""

    def conditions(self, config: ReplayConfig) -> tuple[Condition, ...]:
        return ()

    def engine(self, config: ReplayConfig) -> ReplayStudy:
        return self

    def plan(self, config: ReplayConfig) -> list[Block]:
        from owtsweep.studies.replay.blocks import plan

        return plan(config)

    def backend(self, config: ReplayConfig) -> str:
        from owtsweep.studies.hub.public import backend, resolve_all

        return backend(config, resolve_all(config.schemes, config))

    def run(
        self, config: ReplayConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        from owtsweep.studies.replay.blocks import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        return ["file", "scheme", "measure", "window", "replicate"]

    def tables(self, config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        from owtsweep.studies.replay.results import aggregate

        return aggregate(config, rows)

    def terminal(self, config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        from owtsweep.studies.replay.report import render_answer

        return render_answer(config, tables)

    def drawings(
        self,
        config: ReplayConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        from owtsweep.figures.drawings import save_figure
        from owtsweep.studies.replay.facts import pick_facts
        from owtsweep.studies.replay.figures import histories, place, records, spectrum, traces

        if len(config.grid.files) > 1:
            draw = partial(records.draw, config, tables["records"], tables["advice"])
            return {self.overview(config): save_figure(draw, metadata)}
        advice, failures = tables["advice"], rows[rows["status"] == FAILED]
        # a baseline has no lines in the figures
        advised = str(advice.iloc[0]["recommended"]) if len(advice) else None
        failed = dict(zip(failures["scheme"], failures["reason"], strict=True))
        open_session = cache(partial(traces.Session, config, config.grid.files[0], advised, failed))

        def draw_history(folder: Path, name: str) -> list[Path]:
            # the folder of a question that is not the latest holds its own estimates
            own = folder.parent / ESTIMATES
            path = own if own.is_file() else (find_home(folder.parent) or folder.parent) / ESTIMATES
            quantity, zoom = name.removesuffix("_zoom"), name.endswith("_zoom")

            def draw() -> Figure:
                return histories.draw(open_session(path), quantity, zoom=zoom)

            return save_figure(draw, metadata)(folder, name)

        def draw_of_facts(draw: Callable[..., Figure]) -> Drawing:
            return save_figure(lambda: draw(config, pick_facts(tables["records"])), metadata)

        return {
            **dict.fromkeys(HISTORIES, draw_history),
            "spectrum": draw_of_facts(spectrum.draw),
            "place_in_map": draw_of_facts(place.draw),
        }

    def overview(self, config: ReplayConfig) -> str:
        return "position_zoom" if len(config.grid.files) == 1 else "best_scheme_by_record"
