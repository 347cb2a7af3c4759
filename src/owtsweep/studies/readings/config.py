"""The configuration of the search: the hub study's and the section `calibration`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from owtsweep.config import require
from owtsweep.studies.hub.public import HubConfig


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What to search.

    Attributes
    ----------
    targets
        Name -> `kind` ("published": the distance from the paper's numbers; "settled": the settled
        position MSE, its geometric mean over the grid, under `truth`), `schemes` judged, `tuning`
        to start from, `parameters`, `start` (their values in the first trial), and `truths` (all by
        default). A parameter is a key, or keys joined by "+" that share one value, with
        [low, high, log | linear | int] or a list of options {options: [...]}.
    truths
        Name -> overrides (sensor truth, record length, normalisation) under which "published"
        targets are searched, each on its own.
    trials
        Trials of each search: the same budget for every scheme.
    replicates
        Records per period that a trial is judged on.
    sampler_seeds
        A search is repeated with each of them.
    """

    targets: dict[str, Any]
    truths: dict[str, Any]
    trials: int
    replicates: int
    sampler_seeds: list[int]


@dataclass(frozen=True, kw_only=True)
class ReadingsConfig(HubConfig):
    """All keys of the search."""

    calibration: Calibration

    def check(self) -> None:
        super().check()
        require(
            self.engine != "expected",
            "engine: the search judges records; use engine=batch, not expected",
        )
        calibration = self.calibration
        for key in ("trials", "replicates"):
            value = getattr(calibration, key)
            require(value >= 1, f"calibration.{key}: {value} must be at least 1")
        require(len(calibration.sampler_seeds) > 0, "calibration.sampler_seeds: the list is empty")
