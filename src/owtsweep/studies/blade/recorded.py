"""The section `recorded`: files of a lift in place of a simulated one, and where sensors are."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import NotNegative, Positive, Section, key
from owtsweep.errors import require
from owtsweep.studies.base.keys import key_of_vector
from owtsweep.studies.blade.contract import ANTENNAS, ROOT, UNIT, Geometry

#: By how much a matrix may differ from a rotation, and a quaternion's norm from 1.
NEAR = 1e-3

#: The scheme whose estimates with all fixes stand for the truth of a record.
REFERENCE = "SMOOTHER"


class Recorded(Section):
    """The section `recorded`: files of one lift, and where its sensors are on the blade."""

    imu: str | None = key(
        "table of the inertial unit with the columns time, fx, fy, fz (specific force) and wx, wy, "
        "wz (angular velocity); null: the lift is simulated",
        default=None,
    )
    gnss: list[str] = key(
        "one file per antenna, one to three: a table with the columns time and x, y, z or "
        "latitude, longitude, height, or NMEA sentences (.nmea)",
        default=[],
    )
    columns: list[str] = key(
        "SIGNAL:NAME or SIGNAL:NAME:UNIT where a signal's column has another name or unit",
        default=[],
    )
    shift: float = key(
        "what is added to times of GNSS to get those of the inertial unit", unit="s", default=0.0
    )
    unit: list[float] = key_of_vector("where the inertial unit is", "m", default=UNIT.tolist())
    root: list[float] = key_of_vector("where the root is", "m", default=ROOT.tolist())
    antennas: list[list[float]] = key(
        "where antennas are, in the order of `gnss`", unit="m", default=ANTENNAS.tolist()
    )
    mounting: list[list[float]] = key(
        "rotation that turns vectors of the inertial unit into the blade's axes, three rows",
        default=np.eye(3).tolist(),
    )
    alignment: Positive = key(
        "over how long the specific force is averaged to find the tilt at the start", unit="s",
        default=10.0,
    )  # fmt: skip
    tilt_sigma: Positive = key("error of that tilt", unit="deg", default=0.5)
    heading: float | None = key(
        "heading of the blade at the start, clockwise from north or x, deg; null: that of two "
        "antennas",
        default=None,
    )
    heading_sigma: Positive = key("error of that heading", unit="deg", default=1.0)
    attitude: list[float] | None = key(
        "attitude at the start as a quaternion, scalar first, that turns vectors of the blade into "
        "the frame; null: from alignment and heading",
        default=None,
    )
    velocity_sigma: NotNegative = key("error of the velocity at the start", unit="m/s", default=0.1)

    def check(self) -> None:
        """Check that sensors and rotations can be."""
        require(
            self.imu != "",
            "recorded.imu: name the table of the inertial unit, e.g. recorded.imu=imu.csv "
            "'recorded.gnss=[gnss.csv]' (docs/own_lift.md)",
        )
        if self.imu is None:
            require(not self.gnss, "recorded.gnss: give recorded.imu as well")
            return
        require(
            1 <= len(self.gnss) <= len(self.antennas),
            f"recorded.gnss: {len(self.gnss)} files for the {len(self.antennas)} places in "
            "recorded.antennas; give one to three files, and a place for each",
        )
        require(
            len(self.gnss) <= len(ANTENNAS) and all(len(a) == 3 for a in self.antennas),
            "recorded.antennas: give three numbers in m for each antenna, of which at most three",
        )
        rotation = np.array([row if len(row) == 3 else [np.nan] * 3 for row in self.mounting])
        require(
            rotation.shape == (3, 3)
            and bool(np.abs(rotation @ rotation.T - np.eye(3)).max() < NEAR)
            and float(np.linalg.det(rotation)) > 0.0,
            "recorded.mounting: the rows are no rotation; give three rows of unit length at right "
            "angles to each other, with determinant +1",
        )
        if self.attitude is not None:
            norm = float(np.linalg.norm(self.attitude))
            require(
                len(self.attitude) == 4 and abs(norm - 1.0) < NEAR,
                f"recorded.attitude: a quaternion of norm {norm:g}; give four numbers of norm 1, "
                "scalar first",
            )

    @property
    def geometry(self) -> Geometry:
        """Where root, inertial unit and the antennas with a file are."""
        antennas = np.array(self.antennas[: len(self.gnss)], dtype=float)
        return Geometry(np.array(self.root), np.array(self.unit), antennas)

    @property
    def turn(self) -> Array:
        """The rotation `mounting`, shape (3, 3)."""
        return np.array(self.mounting, dtype=float)
