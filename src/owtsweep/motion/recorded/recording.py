"""The series read from a file: converted to SI units, not resampled, by role ("position_x")."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array


@dataclass(frozen=True)
class Recording:
    """The contents of one file, in SI units, at the file's times.

    Attributes
    ----------
    path
        The file.
    time
        Times in s, strictly increasing, shape (n,).
    channels
        role -> values in SI units (m, m/s, m/s^2, rad), shape (n,), NaN where missing. A role says
        what a channel holds. Roles are position, velocity, acceleration, specific_force, fix (GNSS)
        and reference, each with _x and _y, and yaw.
    names
        role -> the channel's name in the file; "time" is among the roles.
    notes
        What a user should know, one sentence each: assumed units, irregular times, gaps.
    leans
        Axis "x" or "y" -> the channel of the platform's angle that leans it along this axis, and
        the angle in rad, shape (n,), or None if its unit is not known. Empty if the file has no
        such channel, or a specific force, which holds the lean already.
    """

    path: Path
    time: Array
    channels: dict[str, Array]
    names: Mapping[str, str]
    notes: tuple[str, ...]
    leans: Mapping[str, tuple[str, Array | None]] = field(default_factory=dict)

    def has(self, quantity: str) -> bool:
        """Return whether the recording has at least one axis of a quantity such as "fix"."""
        return any(f"{quantity}_{axis}" in self.channels for axis in "xy")

    def let_go(self, quantity: str) -> None:
        """Delete both axes of a quantity such as "fix".

        This frees memory once the caller no longer needs the quantity.
        """
        for axis in "xy":
            self.channels.pop(f"{quantity}_{axis}", None)

    def series(self, role: str) -> tuple[Array, Array]:
        """Return the times (s) and values of a role without missing samples, shape (m,) each."""
        values = self.channels[role]
        there = np.isfinite(values)
        if there.all():  # saves copies of a long record
            return self.time, values
        return self.time[there], values[there]

    def rate(self, role: str) -> float:
        """Return the rate of a role's channel in Hz.

        It is 1 divided by the median interval between the channel's values.
        """
        time, _ = self.series(role)
        return float(1.0 / np.median(np.diff(time)))
