"""The configuration of a replay: the hub study's, and what says how to read a record."""

from __future__ import annotations

from dataclasses import dataclass

from owtsweep.config import require
from owtsweep.studies.hub.public import Grid, HubConfig, one_of, positive

ENGINES = ("batch", "reference")
INPUTS = ("auto", "motion", "sensors")
GNSS = ("auto", "recorded", "from_reference")
GAPS = ("refuse", "interpolate")
MOST_REPLICATES = 10_000


@dataclass(frozen=True, kw_only=True)
class ReplayGrid(Grid):
    """The axes: `files`, the records; the others are those of the expected map."""

    files: list[str]


@dataclass(frozen=True, kw_only=True)
class Roles:
    """One text per role that a channel of a file can have, or null."""

    time: str | None = None
    position_x: str | None = None
    position_y: str | None = None
    velocity_x: str | None = None
    velocity_y: str | None = None
    acceleration_x: str | None = None
    acceleration_y: str | None = None
    specific_force_x: str | None = None
    specific_force_y: str | None = None
    fix_x: str | None = None
    fix_y: str | None = None
    reference_x: str | None = None
    reference_y: str | None = None

    def given(self) -> dict[str, str]:
        """The roles that are not null."""
        return {role: text for role, text in vars(self).items() if text is not None}


@dataclass(frozen=True, kw_only=True)
class ReplaySettings:
    """How a record is taken.

    `input`: motion, sensors or auto; `gnss`: recorded, from_reference or auto (sensors only);
    `replicates` of simulated noise; `cutoff` Hz of the derivatives, null for the reader's choice;
    `band`: edges in Hz within which the spectrum is fitted and judged, null for the key `band`;
    `remove_mean`: put the local origin at the mean; `table`: CSV of the records' sea states.
    """

    input: str
    gnss: str
    replicates: int
    cutoff: float | None
    band: list[float] | None
    remove_mean: bool
    table: str | None


@dataclass(frozen=True, kw_only=True)
class ReplayConfig(HubConfig):
    """All keys of a replay."""

    grid: ReplayGrid
    columns: Roles
    units: Roles
    gaps: str
    replay: ReplaySettings

    def check(self) -> None:
        super().check()
        require(
            self.engine in ENGINES,
            f"engine: {self.engine!r} runs no record; use {' or '.join(ENGINES)}",
        )
        one_of("replay.input", self.replay.input, INPUTS)
        one_of("replay.gnss", self.replay.gnss, GNSS)
        one_of("gaps", self.gaps, GAPS)
        count = self.replay.replicates
        require(
            1 <= count <= MOST_REPLICATES,
            f"replay.replicates: {count} must be between 1 and {MOST_REPLICATES}",
        )
        if self.replay.cutoff is not None:
            positive("replay.cutoff", self.replay.cutoff, "Hz")
        if self.replay.band is not None:
            require(
                len(self.replay.band) == 2 and 0.0 < self.replay.band[0] < self.replay.band[1],
                f"replay.band: {self.replay.band} must be two edges in Hz, e.g. [0.2,0.4]",
            )

    @property
    def fit_band(self) -> tuple[float, float]:
        """Edges (Hz) within which a record's spectrum is fitted and judged."""
        edges = self.band if self.replay.band is None else self.replay.band
        return edges[0], edges[1]
