"""The configuration of the study `readings`: the hub study's keys and the section `calibration`."""

from __future__ import annotations

from typing import ClassVar

from owtsweep.config import Config, Plain, Section, key, require
from owtsweep.studies.hub.public import HubConfig


class Calibration(Section):
    """The section `calibration`: what to search, with how many trials, on how many records.

    Targets and truths are as YAML has them; `searches.plan` checks their keys and values.
    """

    #: A parameter is a key, or keys joined by "+" that share one value.
    targets: dict[str, Plain] = key(
        "name: kind (published: the distance from the paper's numbers; settled: the settled "
        "position MSE, its geometric mean over the grid, under `truth`), schemes judged, tuning to "
        "start from, parameters with [low, high, log or linear or int] or {options: [...]}, start "
        "(their values in the first trial), truths (all by default)"
    )
    truths: dict[str, Plain] = key(
        "name: overrides (sensor truth, record length, normalisation) under which published "
        "targets are searched, each on its own"
    )
    trials: int = key("trials of each search: the same budget for every scheme", ge=1, le=1_000_000)
    replicates: int = key("records per period that a trial is judged on", ge=1, le=10_000)
    sampler_seeds: list[int] = key("a search is repeated with each of them", min_length=1)


class ReadingsConfig(HubConfig):
    """The configuration of the study `readings`: the hub study's keys and `calibration`."""

    #: Each target names its own tuning and schemes, so these keys have no effect.
    inert: ClassVar[frozenset[str]] = Config.inert | {
        "tuning", "baselines", "ekf", "mkf", "hme1", "hme2", "hme",
    }  # fmt: skip

    calibration: Calibration = key("what to search")

    def check(self) -> None:
        """Raise `InputError` if the values cannot work together, e.g. with engine=expected."""
        require(not self.tunings, "tuning: a search starts from one tuning; name one")
        super().check()
        require(
            self.engine != "expected",
            "engine: expected simulates no records, but a search needs records; use engine=batch",
        )
