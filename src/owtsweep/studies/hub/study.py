"""The hub-motion study: the sensitivity study of Ren et al. (2019), sections 5.3-5.4."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep import estimation, evaluation, motion, sensing
from owtsweep.config import Plain
from owtsweep.errors import require
from owtsweep.evaluation.estimate import EstimatedRecord
from owtsweep.studies.hub import kernels
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import SCHEMES, describe, resolve_all
from owtsweep.studies.hub.worlds import find_world, list_departing, list_untold, require_spectrum
from owtsweep.sweep.study import Engine, Lever, Study, Tuned, Varied, add_versions, double, halve

if TYPE_CHECKING:
    from rich.console import RenderableType

    from owtsweep.comparing.comparison import Aspects, Candidate
    from owtsweep.results.conditions import Condition, Value

__all__ = ["HubKeys", "HubStudy"]

#: Packages whose code affects the numbers that the study stores.
ROOMS = (motion, sensing, estimation, evaluation, kernels)


class HubKeys(Study):
    """The base of studies that have the hub's keys: how keys are completed, checked and stored."""

    def complete(self, plain: Plain) -> Plain:
        """Return the keys with numbers in place of `auto`, from the sensors by rule."""
        from owtsweep.studies.hub.tuning_rules import fill_in

        return fill_in(plain)

    def check(self, config: HubConfig) -> None:
        from owtsweep.studies.hub.checks import check

        for part in config.by_tuning().values():
            check(part)

    def describe_origin(self, config: HubConfig) -> str:
        from owtsweep.studies.hub.describe import describe_in_a_line

        return describe_in_a_line(config)

    def describe_code(self, config: HubConfig) -> object:
        one = next(iter(config.by_tuning().values()))
        return SCHEMES.describe_stored(resolve_all(config.schemes, one))

    def hide_code(self, plain: Plain, described: object) -> Plain:
        return {**plain, "schemes": SCHEMES.stand_in(plain.get("schemes"), described)}


class HubStudy(HubKeys):
    """The study of the hub motion; modules that take long to import are imported at first use."""

    name = "hub"
    stretched = ("position", 0, "position northwards (m)")
    numerics_version = add_versions(1, *ROOMS)
    commands = frozenset({"compare", "estimate", "spectrum", "tune", "vary"})
    advised_schemes = ("SKFA",)
    advised_records = 192
    levers = (
        Lever("half the noise of a fix", "sensors.gnss.sigma", halve),
        Lever("twice as many fixes", "sensors.gnss.rate", double, (2.5, 1.5, 3.0, 4.0, 5.0)),
        Lever("half the delay of a fix", "sensors.gnss.delay", halve, (0.4, 0.6, 0.3, 0.2)),
        Lever("half the noise of the IMU", "sensors.imu.sigma", halve),
        Lever("half the walk of the IMU's bias", "sensors.imu.bias_walk", halve),
    )

    def schemes(self) -> dict[str, str]:
        return describe()

    def explain_schemes(self) -> dict[str, str]:
        return SCHEMES.describe()

    def describe_scheme(self, name: str) -> dict[str, str]:
        """Return facts on a scheme in words, as `Study.describe_scheme` says."""
        return SCHEMES.describe_one(name)

    def list_simplicity(self) -> dict[str, int]:
        """Return name -> simplicity of each scheme and baseline, as `Study` says."""
        return SCHEMES.list_simplicity()

    def config_type(self) -> type[HubConfig]:
        return HubConfig

    def list_worlds(self, config: HubConfig) -> dict[str, str]:
        return list_untold(config).tell()

    def check_over(self, config: HubConfig) -> None:
        from owtsweep.studies.base.axes import check_over
        from owtsweep.studies.hub.checks import check_truth
        from owtsweep.studies.hub.engines import find_declaration

        if config.over is None:
            return
        require(
            config.engine != "expected",
            "over: a regret needs records, which engine=expected has not; use engine=batch",
        )
        check_over(find_declaration(config).axes, list_untold(config), check_truth, config)

    def conditions(self, config: HubConfig) -> tuple[Condition, ...]:
        return find_world(config).conditions

    def engine(self, config: HubConfig) -> Engine:
        from owtsweep.studies.hub.engines import make_engine

        return make_engine(config)

    def find_bound(self, config: HubConfig) -> float | None:
        """Return bound (b), of all linear estimators, which may know the motion's spectrum."""
        from owtsweep.studies.hub.bounds import cells

        criterion, measures = config.measures.criterion, config.measures
        judged = criterion in cells.BOUNDED and measures.window == cells.WINDOW
        steady = find_world(config).has_spectrum and not list_departing(config)
        if not (judged and steady and config.sensors.imu.high_pass is None):
            return None
        (period,), (amplitude,) = config.grid.natural_period, config.grid.amplitude
        return cells.find_bounds(config, period, amplitude)[criterion]

    def estimate(self, config: HubConfig, replicate: int) -> EstimatedRecord:
        """Return a record of the grid's only cell, with the estimates of all schemes."""
        from owtsweep.studies.base.estimating import estimate_record
        from owtsweep.studies.hub.engines import find_declaration

        return estimate_record(find_declaration(config), config, replicate)

    def describe_run(self, run: Candidate) -> Aspects:
        """Describe a run for `compare`, with the boundary of HME1 and HME2."""
        from owtsweep.studies.hub.engines import describe_run

        return describe_run(run)

    def write_spectrum(
        self, config: HubConfig, folder: Path, *, metadata: Mapping[str, str]
    ) -> tuple[list[Path], RenderableType]:
        """Write error_spectra.png, error_spectra.svg, spectrum.csv and noise_floor.csv."""
        from owtsweep.studies.hub.figures.spectrum_tables import write

        require_spectrum(config, "`spectrum`")
        return write(config, folder, metadata)

    def count_trials(self, config: HubConfig) -> int:
        from owtsweep.studies.hub.tuning.tuned import list_tunable

        require_spectrum(config, "`tune`")
        return len(list_tunable(config)) * config.tune.trials

    def tune(self, config: HubConfig, advance: Callable[[str], None]) -> Tuned:
        from owtsweep.studies.hub.tuning.tuned import tune

        return tune(config, advance)

    def predict_vary(self, configs: Mapping[Value, HubConfig]) -> tuple[float, float] | None:
        """Return the time and the memory of the expected errors, as `Study` says."""
        from owtsweep.studies.hub.engines import PROCESS
        from owtsweep.studies.hub.varying import SECONDS

        schemes = sum(len(resolve_all(config.schemes)) for config in configs.values())
        return SECONDS * schemes, PROCESS

    def predict_tune(self, config: HubConfig) -> tuple[float, float] | None:
        """Return the time and the memory of a search by expected errors, as `Study` says."""
        from owtsweep.studies.hub.engines import PROCESS
        from owtsweep.studies.hub.tuning.search import SECONDS, has_curves
        from owtsweep.studies.hub.tuning.tuned import list_tunable

        schemes = list_tunable(config)
        if not all(map(has_curves, schemes)):
            return None
        periods = len(config.grid.natural_period)
        return SECONDS * config.tune.trials * periods * len(schemes), PROCESS

    def list_vary_defaults(self, plain: Plain) -> list[str]:
        """Return the overrides of `vary`: a tuning that follows the sensors, and one motion."""
        from owtsweep.studies.hub.varying import DEFAULTS

        return DEFAULTS

    def check_vary(self, along: Condition, configs: Mapping[Value, HubConfig]) -> None:
        from owtsweep.studies.hub.varying import check

        check(along, configs)

    def vary(self, along: Condition, configs: Mapping[Value, HubConfig]) -> Varied:
        """Compute the settled errors of all schemes and baselines with each configuration."""
        from owtsweep.studies.base.varying.varied import VariedErrors
        from owtsweep.studies.hub.varying import compute

        return VariedErrors(compute(along, configs))
