"""The configuration of a replay: the keys of the hub study, and keys on how to read a record."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from owtsweep.config import Positive, Section, key, require
from owtsweep.motion.recorded import MotionKind, Rotation
from owtsweep.studies.hub.public import Grid, HubConfig
from owtsweep.studies.replay.files import hash_file

#: Hexadecimal digits of a record's hash in the run folder's name, and the most bytes before them.
DIGITS, LONGEST_START = 8, 235


class ReplayGrid(Grid):
    """The section `grid`: the record files, and the axes of the map of expected errors."""

    files: list[str] = key("the records; the command line fills it from its FILE words")


class Roles(Section):
    """The sections `columns` and `units`: the name or the unit of each role's channel, or null."""

    time: str | None = key("time", default=None)
    position_x: str | None = key("the motion, or a reference beside a specific force", default=None)
    position_y: str | None = key("as position_x", default=None)
    velocity_x: str | None = key("of the motion", default=None)
    velocity_y: str | None = key("of the motion", default=None)
    acceleration_x: str | None = key("of the motion", default=None)
    acceleration_y: str | None = key("of the motion", default=None)
    specific_force_x: str | None = key("of the IMU, in its own frame", default=None)
    specific_force_y: str | None = key("of the IMU, in its own frame", default=None)
    fix_x: str | None = key("position fixes, at the times of their arrival", default=None)
    fix_y: str | None = key("position fixes, at the times of their arrival", default=None)
    reference_x: str | None = key("a position to measure the errors against", default=None)
    reference_y: str | None = key("a position to measure the errors against", default=None)
    platform_surge: str | None = key("of the platform's reference point along x", default=None)
    platform_sway: str | None = key("as platform_surge, along y", default=None)
    platform_roll: str | None = key("turn of the platform about x", default=None)
    platform_pitch: str | None = key("turn of the platform about y", default=None)
    platform_yaw: str | None = key("turn of the platform about z", default=None)
    tower_x: str | None = key(
        "displacement of the tower top from its base by bending", default=None
    )
    tower_y: str | None = key("as tower_x", default=None)
    tower_z: str | None = key("as tower_x", default=None)

    def given(self) -> dict[str, str]:
        """Return role -> text, without the roles whose value is null."""
        return self.model_dump(include={*Roles.model_fields}, exclude_none=True)


class Columns(Roles):
    """The section `columns`: a channel for each role, and which motion the channels make."""

    motion: MotionKind = key(
        "auto: the hub's, composed from platform and tower where the file has it in parts; tower: "
        "the tower's bending alone; rigid: the platform with a stiff tower; platform: the "
        "platform's reference point alone",
        default="auto",
    )
    tower_height: Positive | None = key(
        "height of the tower top above the platform's reference point, to compose the motion",
        default=None,
        unit="m",
    )

    rotation: Rotation = key(
        "how the platform's angles are to be read. zyx: turns about z, y and x, as in OpenFAST "
        "from 4.0 on; small: the small angles of FAST and of OpenFAST before",
        default="zyx",
    )


class ReplaySettings(Section):
    """The section `replay`: how a record is read and used."""

    input: Literal["auto", "motion", "sensors"] = key(
        "what the file holds; auto: sensors where there is a specific force"
    )
    gnss: Literal["auto", "recorded", "from_reference"] = key(
        "where fixes come from (sensors only); auto: recorded where there are some"
    )
    replicates: int = key("draws of the simulated noise", ge=1, le=10_000)
    cutoff: Positive | None = key("of the derivatives; null: chosen by the reader", unit="Hz")
    band: list[Positive] | None = key(
        "edges within which the spectrum is fitted and judged; null: the key band",
        unit="Hz",
        form="two edges in Hz, e.g. [0.2,0.4]",
        min_length=2,
        max_length=2,
    )
    remove_mean: bool = key("put the local origin at the mean of the motion, reference or fixes")
    table: str | None = key("CSV with the column file and others (Hs, Tp), the axes of the map")
    noise: Literal["estimate", "stated"] = key(
        "of recorded sensors; estimate: from the record too, with advice for both; stated: taken "
        "as it is",
        default="estimate",
    )
    disagreement: Literal["refuse", "accept"] = key(
        "what to do if specific force and positions contradict each other", default="refuse"
    )


class ReplayConfig(HubConfig):
    """The configuration of a replay: the hub study's keys, and keys on how to read a record."""

    #: Keys that describe the simulation of a record have no effect here.
    inert: ClassVar[frozenset[str]] = HubConfig.inert - {"measures.window"} | {
        "evaluation", "record", "spectrum", "normalise", "wave_direction", "measures.extremes",
        "replay.table",
    }  # fmt: skip

    engine: Literal["batch", "reference"] = key(
        "batch: compiled; reference: the algorithms as written, slow", default="batch"
    )
    grid: ReplayGrid = key("the records, and the axes of the expected map")
    columns: Columns = key("role: channel of the file; null: the well-known name, if it is there")
    units: Roles = key("role: unit of the channel; null: that of the file, or SI")
    gaps: Literal["refuse", "interpolate"] = key("what to do with gaps of motion or specific force")
    replay: ReplaySettings = key("how a record is taken")

    def check(self) -> None:
        """Raise `InputError` if values cannot work together, e.g. both edges of replay.band."""
        require(not self.tunings, "tuning: a replay takes one tuning; run it once with each")
        require(
            self.motion.envelope is None,
            "motion.envelope: a replay takes its motion from the record; use null",
        )
        super().check()
        require(
            not self.baselines,
            "baselines: a replay always judges NONE, HOLD and DELTA; leave the key out, or name "
            "them in schemes to see their estimates too",
        )
        require(
            self.sensors.imu.high_pass is None and self.sensors.gnss.scale == 1.0,
            "sensors.imu.high_pass, sensors.gnss.scale: a replay does not simulate these faults; "
            "use null and 1",
        )
        band = self.replay.band
        require(
            band is None or band[0] < band[1],
            f"replay.band: {band} must be two edges in Hz, the lower one first, e.g. [0.2,0.4]",
        )

    def reading(self) -> dict[str, Any]:
        """Return the arguments that `motion.recorded.read` and `describe` have in common."""
        named = {"columns": self.columns.given(), "units": self.units.given()}
        return named | self.columns.model_dump(exclude={*Roles.model_fields})

    def start_of_folder(self) -> str:
        """Return the experiment; for a single record also a digest of the record's bytes.

        So records with one name, from different folders, do not share a run folder.
        """
        if len(self.grid.files) != 1:
            return self.experiment
        (file,) = self.grid.files
        start = self.experiment.encode()[:LONGEST_START].decode(errors="ignore")
        return f"{start}-{hash_file(file)[:DIGITS]}"

    @property
    def fit_band(self) -> tuple[float, float]:
        """The edges (Hz) of the band of fitted spectra: `replay.band`, or else `band`."""
        edges = self.band if self.replay.band is None else self.replay.band
        return edges[0], edges[1]
