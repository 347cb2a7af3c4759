"""The inference as one object: tables, emulators, scatter, and the likelihood of each reading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

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

#: `tuning=paper`, in which scatter is computed until a reading has a mode of its own.
PAPER = {
    "ekf_q_a": 2.07, "ekf_q_b": 2.75e-7, "ekf_p0": 1.98, "ekf_r_gnss": 5.5e-4,
    "q_a": 21.8, "q_b": 4.24e-7, "p0": 4.62, "r_gnss": 0.35,
    "smoother_window": 19.0, "hme2_r_gnss": 0.126, "horizon": 22.0,
    "mhe_q_a": 1.21e-3, "mhe_q_b": 3.15e-7, "bias_walk": 1e-4, "bias_initial": 0.02,
}  # fmt: skip
assert list(PAPER) == NAMES


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

    def scatter(self, reading: Reading, settings: Mapping[str, float] | None = None) -> Scatter:
        """Return the scatter of single records, with settings.

        Without, it is that of `first_of`.
        """
        of, chosen = (reading, settings) if settings else first_of(reading)
        return find_scatter(load_records(self.folder, of, chosen), reading)

    def likelihood(
        self, reading: Reading, settings: Mapping[str, float] | None = None
    ) -> Likelihood:
        return Likelihood(reading, self.emulators(reading), self.scatter(reading, settings))


def first_of(reading: Reading) -> tuple[Reading, dict[str, float]]:
    """Return what gives the scatter until a reading has a mode: `tuning=paper`, a level IMU."""
    return replace(reading, force="level", spectrum="middle", seeds="own"), PAPER


def load_records(folder: Path, reading: Reading, settings: Mapping[str, float]) -> Array:
    """Return what `simulate_records` does, kept in a folder."""
    chosen = dict(settings)

    def make() -> dict[str, Array]:
        return {"numbers": simulate_records(reading, chosen)}

    of = replace(reading, seeds="own")  # seeds are in no record
    said = (of, chosen, RECORDS)
    return keep(folder, "records", said, make)["numbers"]
