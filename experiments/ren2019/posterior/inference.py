"""The inference as one object: tables, emulators, scatter, and the likelihood of each reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from experiments.ren2019.evidence import SCHEMES
from experiments.ren2019.posterior.components import Components
from experiments.ren2019.posterior.emulator import Emulator
from experiments.ren2019.posterior.likelihood import Likelihood, fit_emulators
from experiments.ren2019.posterior.records import (
    RECORDS,
    Scatter,
    find_scatter,
    simulate_records,
)
from experiments.ren2019.posterior.settings import NAMES, Reading, from_unit
from experiments.ren2019.posterior.tables import keep, load_table
from owtsweep.arrays import Array

#: What a search had found that scored winners and boundaries too, before there was a posterior. The
#: first look has its scatter, and what was held out is judged by it too.
SEARCHED = {
    "ekf_q_a": 2.07, "ekf_q_b": 2.75e-7, "ekf_p0": 1.98, "ekf_r_gnss": 5.5e-4,
    "q_a": 21.8, "q_b": 4.24e-7, "p0": 4.62, "r_gnss": 0.35,
    "smoother_window": 19.0, "hme2_r_gnss": 0.126, "horizon": 22.0,
    "mhe_q_a": 1.21e-3, "mhe_q_b": 3.15e-7, "bias_walk": 1e-4, "bias_initial": 0.02,
}  # fmt: skip
assert list(SEARCHED) == NAMES


#: Settings by name, of one draw or several of a posterior.
Draws = Sequence[Mapping[str, float]]


def name_settings(point: Array) -> dict[str, float]:
    """Return name -> value of the settings at a point of the cube."""
    return dict(zip(NAMES, from_unit(point[: len(NAMES)]).tolist(), strict=True))


@dataclass
class Inference:
    """Tables of components, and what was fitted to them.

    folder: of the tables, which take half an hour.
    """

    folder: Path
    hyper: dict[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.tables: dict[str, tuple[Array, Components]] = {
            scheme: load_table(scheme, self.folder) for scheme in SCHEMES
        }

    def emulators(self, reading: Reading) -> dict[str, Emulator]:
        return fit_emulators(self.tables, reading, self.hyper)

    def scatter(self, reading: Reading, draws: Draws = (), first: int = 0) -> Scatter:
        """Return the scatter of single records, at draws of the settings; see `load_records`.

        Without draws, it is that of `first_of`.
        """
        of, chosen = (reading, draws) if draws else first_of(reading)
        return find_scatter(load_records(self.folder, of, chosen, first), reading)

    def likelihood(self, reading: Reading, draws: Draws = (), first: int = 0) -> Likelihood:
        return Likelihood(reading, self.emulators(reading), self.scatter(reading, draws, first))


def first_of(reading: Reading) -> tuple[Reading, Draws]:
    """Return what gives the scatter until a reading has draws: `SEARCHED`, a level IMU."""
    return replace(reading, force="level", spectrum="middle", seeds="own"), [SEARCHED]


def load_records(folder: Path, reading: Reading, draws: Draws, first: int = 0) -> Array:
    """Return what `simulate_records` does at each draw, shape (draws, 64, records), kept.

    All draws together have `RECORDS` records, numbered from `first`.
    """
    of = replace(reading, seeds="own")  # seeds are in no record
    chosen, count = list(map(dict, draws)), RECORDS // len(draws)

    def make() -> dict[str, Array]:
        starts = range(first, first + RECORDS, count)
        made = [
            simulate_records(of, settings, range(start, start + count))
            for settings, start in zip(chosen, starts, strict=True)
        ]
        return {"numbers": np.array(made)}

    said = (of, chosen, first, RECORDS)
    return keep(folder, "records", said, make)["numbers"]
