"""The hub study's engines: with records (run step by step or by kernels), or without records."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, ClassVar

from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.summary import summarise
from owtsweep.studies.hub import baseline_names, blocks, criteria, figures
from owtsweep.studies.hub.conditions import CONDITIONS, make_cube
from owtsweep.studies.hub.expected import answers, drawing, engine
from owtsweep.studies.hub.schemes import list_entries, resolve_all
from owtsweep.studies.hub.winners import find_winners

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.study import Engine

logger = logging.getLogger(__name__)


class _Engine:
    """The part that both engines share: the columns that identify a row, and the map as result.

    The map is a picture of the best scheme at each natural period and amplitude.
    """

    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("scheme", "measure", "window"), str),
        **dict.fromkeys(("natural_period", "replicate", "amplitude", "n_samples"), float),
        **dict.fromkeys(("motion", "cross", "noise", "value"), float),
    }

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return ["natural_period", "scheme", "measure", "window", "amplitude", "replicate"]

    def terminal(self, config: HubConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the map of the best schemes as a coloured grid for the terminal."""
        from owtsweep.figures.terminal import grid

        criterion, window = config.measures.criterion, config.measures.window
        table, names, notes = find_winners(config, tables["best_scheme"], criterion)
        return grid(table, names, CONDITIONS, criterion, window, notes=notes)

    def overview(self, config: HubConfig) -> str:
        """Return the name of the map of the best schemes (figure 18 of Ren et al. 2019)."""
        return figures.MAP


class RecordsEngine(_Engine):
    """The engine of `engine: batch` and `engine: reference`: runs schemes on simulated records."""

    samples = True
    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)
    drawings = staticmethod(figures.drawings)

    def backend(self, config: HubConfig) -> str:
        """Return "threading" if all schemes run by kernels, which release the GIL; else "loky".

        Log a warning for a scheme that has no kernel because of its constraints.
        """
        schemes = resolve_all(list_entries(config), config)
        for scheme in schemes:
            if config.engine == "batch" and getattr(scheme, "constrained", False):
                logger.warning(
                    "%s: its constraints leave no kernel that serves all amplitudes; it runs step "
                    "by step, amplitude by amplitude",
                    scheme.name,
                )
        return blocks.backend(config, schemes)

    def tables(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Make the tables summary and best_scheme, with confidence intervals."""
        cube = make_cube(config, rows, baselines=True)
        window = config.measures.window
        best = find_best_schemes(cube, window, criteria(config), baseline_names(config))
        return {"summary": summarise(cube), "best_scheme": best}


class ExpectedEngine(_Engine):
    """The engine of `engine: expected`: computes the schemes' expected errors without records."""

    samples = False
    plan = staticmethod(engine.plan)
    run = staticmethod(engine.run)
    tables = staticmethod(answers.tables)
    drawings = staticmethod(drawing.drawings)

    def backend(self, config: HubConfig) -> str:
        """Return "threading": nearly all the time is spent in kernels, which release the GIL."""
        return "threading"


#: Value of the key `engine` -> class of the engine.
ENGINES: dict[str, Callable[[], Engine]] = {
    "batch": RecordsEngine,
    "reference": RecordsEngine,
    "expected": ExpectedEngine,
}
