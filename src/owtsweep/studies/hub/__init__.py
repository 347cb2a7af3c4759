"""The hub-motion study: the sensitivity study of Ren et al. (2019), sections 5.3-5.4."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep import estimation, evaluation, motion, sensing
from owtsweep.figures import palette
from owtsweep.studies.hub import kernels
from owtsweep.studies.hub.looks import LOOKS
from owtsweep.sweep.study import add_versions

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.comparing.comparison import Comparison, Findings
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.study import Engine, Tuned

__all__ = ["HubStudy"]

#: Packages whose code affects the numbers that the study stores.
ROOMS = (motion, sensing, estimation, evaluation, kernels)

palette.reserve(LOOKS)


class HubStudy:
    """The study of the hub motion, an `owtsweep.sweep.study.Study`.

    Modules that take long to import are imported at first use.
    """

    name = "hub"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)

    def schemes(self) -> dict[str, str]:
        """Return scheme -> description, for all schemes of the study."""
        from owtsweep.studies.hub.schemes import REGISTERED

        return dict(REGISTERED)

    def config_type(self) -> type[HubConfig]:
        """Return the model of the study's configuration."""
        from owtsweep.studies.hub.config import HubConfig

        return HubConfig

    def conditions(self, config: HubConfig) -> tuple[Condition, ...]:
        """Return the conditions: natural period and amplitude."""
        from owtsweep.studies.hub.conditions import CONDITIONS

        return CONDITIONS

    def engine(self, config: HubConfig) -> Engine:
        """Return a new engine, the one that the key `engine` names."""
        from owtsweep.studies.hub.engines import ENGINES

        return ENGINES[config.engine]()

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """Compare runs: how the best schemes, their boundary and their errors change."""
        from owtsweep.comparing.compare import compare
        from owtsweep.studies.hub.comparing import describe_run

        return compare(comparison, folder, describe_run, metadata=metadata)

    def write_fidelity(
        self, config: HubConfig, rows: pd.DataFrame, folder: Path, *, metadata: Mapping[str, str]
    ) -> list[Path]:
        """Compare a run with the numbers and statements of Ren et al. (2019); write a report.

        Return the files that were written.
        """
        from owtsweep.studies.hub.fidelity.report import write_report

        return write_report(config, rows, folder, metadata)

    def write_spectrum(
        self, config: HubConfig, folder: Path, *, metadata: Mapping[str, str]
    ) -> tuple[list[Path], RenderableType]:
        """Write error_spectra.png, error_spectra.svg, spectrum.csv and noise_floor.csv.

        Return these files, and a table of the noise floors for the terminal.
        """
        from owtsweep.studies.hub.figures.spectrum_tables import write

        return write(config, folder, metadata)

    def count_trials(self, config: HubConfig) -> int:
        """Return how many trials the command `tune` will make, for all schemes together."""
        from owtsweep.studies.hub.tuning.tuned import list_tunable

        return len(list_tunable(config)) * config.tune.trials

    def tune(self, config: HubConfig, advance: Callable[[str], None]) -> Tuned:
        """Search the best numbers of each scheme for these sensors; return them."""
        from owtsweep.studies.hub.tuning.tuned import tune

        return tune(config, advance)


def criteria(config: HubConfig) -> tuple[str, ...]:
    """Return the criteria of best_scheme.csv: position, velocity, and the configured criterion."""
    return tuple(dict.fromkeys(("position", "velocity", config.measures.criterion)))


def scheme_names(config: Any) -> list[str]:
    """Return the names of a run's schemes, in the order of the configuration."""
    from owtsweep.studies.hub.schemes import resolve_all

    return [scheme.name for scheme in resolve_all(config.schemes)]
