"""Tunes all schemes of a run, and tells what was found: as a tuning file, and as a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep._version import __version__
from owtsweep.config import Plain, with_values
from owtsweep.errors import require
from owtsweep.io.terminal import start_table
from owtsweep.studies.base.tuning.tuned import Gain, compare, dump_tuning, require_other_seed
from owtsweep.studies.hub.bounds.kalman import kalman_bound
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme, resolve_all
from owtsweep.studies.hub.describe import describe_truth
from owtsweep.studies.hub.tuning.search import amplitudes, errors_on_records, find_space, search

if TYPE_CHECKING:
    from rich.console import RenderableType


def list_tunable(config: HubConfig) -> list[Scheme]:
    """Return the schemes of a run whose numbers can be searched.

    Raises InputError if there is none, or the search would see the records that judge it.
    """
    schemes = [s for s in resolve_all(config.schemes, config) if find_space(config, s.name)]
    require(
        bool(schemes),
        "schemes: `tune` knows the numbers of EKF, MKF, HME1 and HME2 only; name one of them",
    )
    require_other_seed(config)
    return schemes


def tune(config: HubConfig, advance: Callable[[str], None]) -> TunedSchemes:
    """Search the best numbers of each scheme; call `advance` with its name after each trial.

    If the user stops the search, the best numbers so far are returned.
    """
    schemes = list_tunable(config)
    best: dict[str, Plain] = {}
    made, stopped = 0, False
    try:
        for scheme in schemes:
            best[scheme.name] = {}
            trials = search(config, scheme)
            least = next(trials).score
            for trial in trials:
                made += 1
                if trial.score < least:
                    least, best[scheme.name] = trial.score, trial.values
                advance(scheme.name)
    except KeyboardInterrupt:
        stopped = True
    return TunedSchemes(config, best, made, stopped)


@dataclass(frozen=True)
class TunedSchemes:
    """The best numbers found, an `owtsweep.sweep.study.Tuned`.

    before: the configuration with the tuning that the search began with.
    best: scheme -> the best values by key; empty if no trial was better than that tuning.
    trials: number of trials made, of all schemes together.
    stopped: whether the user stopped the search.
    """

    before: HubConfig
    best: Mapping[str, Plain]
    trials: int
    stopped: bool

    @property
    def after(self) -> HubConfig:
        """The configuration with the best numbers."""
        values = {key: v for found in self.best.values() for key, v in found.items()}
        return with_values(self.before, values)

    def text(self, name: str) -> str:
        return dump_tuning(name, self.after, self._describe())

    def _describe(self) -> list[str]:
        config, each = self.before, self.before.tune.trials
        sensors = config.sensors
        return [
            f"Made by `owtsweep tune`, version {__version__}, from {config.tuning_name}.",
            f"GNSS: {sensors.gnss.sigma:g} m, {sensors.gnss.rate:g} Hz, delay "
            f"{sensors.gnss.delay:g} s; IMU: {sensors.imu.sigma:g} m/s^2, {sensors.imu.rate:g} Hz.",
            f"Truth: {describe_truth(config)}; amplitudes {_range(config)}.",
            f"{each} trials for each of {', '.join(self.best)}, seed {config.tune.seed}"
            + (f"; stopped after {self.trials} trials." if self.stopped else "."),
        ]

    def judge(self) -> RenderableType:
        from rich.console import Group
        from rich.text import Text

        config = self.before
        gains = judge(config, self.after, list(self.best))
        bound = kalman_bound(config)
        unit = "(m/s)²" if config.measures.criterion == "velocity" else "m²"
        table = start_table(
            f"Mean square error of {config.measures.criterion}, {config.tuning_name} and tuned,"
            f" amplitudes {_range(config)}\nTruth: {describe_truth(config)}; "
            f"{config.tune.replicates} records per natural period, seed {config.seed}"
        )
        table.add_column("scheme")
        before, after = f"{config.tuning_name} ({unit})", f"tuned ({unit})"
        for column in (before, after, "change", "95 %", "tuned / bound"):
            table.add_column(column, justify="right")
        for name, gain in gains.items():
            table.add_row(Text(name), *gain.tell(), f"{gain.after / bound:.2f}")
        text = (
            f"Bound: {bound:.3g} {unit}, the least error of an estimator that assumes nothing "
            "about the motion. MSE are geometric means over natural periods and amplitudes, after "
            f"the first {config.measures.settling_time:g} s."
        )
        return Group(table, Text(text))


def _range(config: HubConfig) -> str:
    judged = amplitudes(config)
    return f"{judged[0]:g} to {judged[-1]:g} m"


def judge(before: HubConfig, after: HubConfig, schemes: Sequence[str]) -> dict[str, Gain]:
    """Run schemes with two tunings on the same records; return what each has gained."""
    count = before.tune.replicates
    errors = [
        errors_on_records(config, schemes, count).reshape(len(schemes), -1, count)
        for config in (before, after)
    ]
    return {name: compare(*parts) for name, *parts in zip(schemes, *errors, strict=True)}
