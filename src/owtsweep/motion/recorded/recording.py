"""A recording: a file that has been read, by roles, in SI units, at the file's times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class Recording:
    """One file in SI units, at the file's times.

    Attributes
    ----------
    path
        The file.
    time
        (n,) s, strictly increasing.
    channels
        role -> (n,) values in SI units (m, m/s, m/s^2, rad), NaN where missing. Roles are
        position, velocity, acceleration, specific_force, fix (GNSS) and reference, each with _x
        and _y, and yaw.
    names
        role -> the channel's name in the file; "time" is among them.
    notes
        What a user should know: assumed units, irregular times, gaps.
    """

    path: Path
    time: Array
    channels: dict[str, Array]
    names: Mapping[str, str]
    notes: tuple[str, ...]

    def has(self, quantity: str) -> bool:
        """Whether the recording has at least one axis of a quantity such as "fix"."""
        return any(f"{quantity}_{axis}" in self.channels for axis in "xy")

    def let_go(self, quantity: str) -> None:
        """Drop a quantity that the caller has copied, so that memory does not hold it twice."""
        for axis in "xy":
            self.channels.pop(f"{quantity}_{axis}", None)

    def series(self, role: str) -> tuple[Array, Array]:
        """Times (s) and values of a channel, (m,) each, without its missing samples."""
        values = self.channels[role]
        there = np.isfinite(values)
        if there.all():  # saves copies of a long record
            return self.time, values
        return self.time[there], values[there]

    def rate(self, role: str) -> float:
        """Samples per second of a channel, from the median interval between its values."""
        time, _ = self.series(role)
        return float(1.0 / np.median(np.diff(time)))
