"""Read a recorded structure: columns of force, displacement, velocity, acceleration, rotation.

A column is called kind_height or kind_height_direction, e.g. `a_012`, `theta_3.5`, `F_24_fa`:

    x  displacement   v  velocity   a  acceleration   theta  rotation
    F  force on the structure at a cut, along x       M  moment on the structure at a cut

The height is in m above ground, the direction `fa` (taken where none is written) or `ss`. A unit
may stand behind the name, `a_012 (g)`; without one the column is in SI units. Other names are
translated by `recorded.columns`. Velocities are read and checked, but no scheme returns a velocity
to compare with.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Section, key
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded import open_table
from owtsweep.motion.recorded.checks import require_possible
from owtsweep.motion.recorded.columns import guess_roles
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.timing import fit_comb
from owtsweep.motion.recorded.units import find_factor

#: Kinds of columns with the dimension of their unit.
KINDS = {
    "x": "length",
    "v": "velocity",
    "a": "acceleration",
    "theta": "angle",
    "F": "force",
    "M": "moment",
}
#: Units of the dimensions that other recordings do not have, with their factors to SI.
UNITS = {
    "force": {"N": 1.0, "kN": 1e3, "MN": 1e6},
    "moment": {"Nm": 1.0, "kNm": 1e3, "MNm": 1e6},
}
NAME = re.compile(r"(theta|[xvaFM])_(\d+(?:\.\d+)?)(?:_(fa|ss))?")
#: Heights nearer than this are the same, m.
NEAR = 1e-6
#: Fewest rows of a record.
FEWEST = 32


class Recorded(Section):
    """The section `recorded`: a record of a structure in place of a simulated truth."""

    file: str | None = key(
        "table with a column of time and columns such as a_012 (docs/tower.md); null: the truth is "
        "simulated",
        default=None,
    )
    columns: list[str] = key(
        "CHANNEL:NAME where a channel's column has another name in the file, e.g. [a_012:ACC3]",
        default_factory=list,
    )

    def list_names(self) -> dict[str, str]:
        """Return channel -> name of its column, for the renamed channels.

        Raises
        ------
        InputError
            If an item has no colon, or a channel is there twice.
        """
        names: dict[str, str] = {}
        for item in self.columns:
            channel, colon, name = item.partition(":")
            require(
                bool(colon) and channel not in names,
                f"recorded.columns: {item!r} is not CHANNEL:NAME, or the channel is there twice; "
                "write e.g. recorded.columns=[time:clock,a_012:ACC3]",
            )
            names[channel.strip()] = name.strip()
        return names


@dataclass(frozen=True)
class Signal:
    """One column of a record, in SI units.

    Attributes
    ----------
    kind
        A key of `KINDS`.
    height
        Height above ground, m.
    direction
        "fa" or "ss".
    column
        The column's name in the file.
    values
        Shape (steps,).
    """

    kind: str
    height: float
    direction: str
    column: str
    values: Array


@dataclass(frozen=True)
class RecordedStructure:
    """A recorded structure.

    Attributes
    ----------
    path
        The file.
    step
        Time between two rows, s.
    signals
        The columns whose names say what they are.
    unused
        Names of the other columns, time excepted.
    """

    path: Path
    step: float
    signals: tuple[Signal, ...]
    unused: tuple[str, ...]

    @property
    def steps(self) -> int:
        """The number of rows."""
        return len(self.signals[0].values)

    @property
    def directions(self) -> tuple[str, ...]:
        """The directions that the record has columns of, "fa" before "ss"."""
        return tuple(sorted({signal.direction for signal in self.signals}))

    def find(self, kind: str, height: float, direction: str) -> Array | None:
        """Return a column's values, shape (steps,); None if there is no such column."""
        for signal in self.signals:
            same = signal.kind == kind and signal.direction == direction
            if same and abs(signal.height - height) <= NEAR:
                return signal.values
        return None

    def need(self, kind: str, height: float, direction: str) -> Array:
        """Return a column's values, shape (steps,).

        Raises
        ------
        InputError
            If there is no such column; the message lists the columns of the same kind.
        """
        values = self.find(kind, height, direction)
        if values is None:
            others = [s.column for s in self.signals if (s.kind, s.direction) == (kind, direction)]
            there = f"it has {', '.join(others)}" if others else f"it has none of kind {kind}"
            hint = f"; of unknown meaning are {', '.join(self.unused[:8])}" if self.unused else ""
            raise InputError(
                f"{self.path}: no column {kind}_{height:03g} of direction {direction} for the "
                f"sensor there; {there}{hint}; name the column by recorded.columns or choose other "
                "sensors"
            )
        return values


def read_record(path: str | Path, columns: Mapping[str, str] | None = None) -> RecordedStructure:
    """Read and check a recorded structure.

    Parameters
    ----------
    path
        A table in any format that recordings may have (docs/replay.md).
    columns
        Channel, e.g. "a_012" or "time" -> name of its column in the file.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, time is not uniform, a number is missing or
        absurdly large, or a unit is not known.
    """
    table = open_table(path)
    renamed = {}
    for channel, name in (columns or {}).items():
        where = f"recorded.columns.{channel}"
        require(
            channel == "time" or NAME.fullmatch(channel) is not None,
            f"{where}: no channel has such a name; write a kind, a height in m above ground, and "
            "perhaps a direction, e.g. a_012, theta_3.5 or F_175_fa",
        )
        require(
            name in table.names,
            f"{where}: {path} has no column {name!r}; it has {_list(table.names)}",
        )
        renamed[name] = channel
    time = next((name for name, channel in renamed.items() if channel == "time"), None)
    if time is None:
        time = guess_roles(table.names).get("time")
    if time is None:
        raise InputError(
            f"{path}: no column of time among {_list(table.names)}; call one `time`, or name it by "
            "recorded.columns=[time:NAME]"
        )
    others = [name for name in table.names if name != time]
    used = {name: match for name in others if (match := NAME.fullmatch(renamed.get(name, name)))}
    require(
        bool(used),
        f"{path}: no column has a name such as a_012 or F_175; it has {_list(others)}; name the "
        "columns by recorded.columns",
    )
    loaded = table.load([time, *used], None)
    factor = find_factor(table.unit(time) or "s", "time", f"{path}: column {time}")
    step = _find_step(path, time, loaded[time] * factor)
    signals = []
    for name, match in used.items():
        values = loaded[name] * _find_factor(table, name, KINDS[match[1]])
        missing = np.flatnonzero(~np.isfinite(values))
        require(
            len(missing) == 0,
            f"{path}: column {name} has no number in data row "
            f"{missing[0] + 1 if len(missing) else 0} ({len(missing)} such rows in all); fill the "
            "gaps or cut the record there",
        )
        require_possible(
            f"{path}: column {name}",
            values,
            "check its unit, and mend damaged rows",
            load=match[1] in ("F", "M"),
        )
        signals.append(Signal(match[1], float(match[2]), match[3] or "fa", name, values))
    _refuse_repeats(path, signals)
    return RecordedStructure(
        Path(path), step, tuple(signals), tuple(name for name in others if name not in used)
    )


def _find_step(path: str | Path, name: str, time: Array) -> float:
    """Return the time between two rows in s; `time` (s) is the column `name`."""
    require(
        len(time) >= FEWEST,
        f"{path}: it has {len(time)} rows; a record needs {FEWEST} or more",
    )
    missing = np.flatnonzero(~np.isfinite(time))
    require(
        len(missing) == 0,
        f"{path}: column {name} has no time in data row {missing[0] + 1 if len(missing) else 0}",
    )
    interval = np.diff(time)
    worst = int(np.argmax(np.abs(interval - np.median(interval))))
    uniform = interval.min() > 0.0 and (comb := fit_comb(time)).uniform
    require(
        bool(uniform) and comb.count == len(time),
        f"{path}: column {name} is not uniform: {interval[worst]:.6g} s between data rows "
        f"{worst + 1} and {worst + 2}, elsewhere {np.median(interval):.6g} s; resample the record "
        "to one step",
    )
    return float(comb.step)


def _find_factor(table: ChannelTable, name: str, dimension: str) -> float:
    """Return the factor to SI of a column's unit; 1 if the file states no unit."""
    unit, where = table.unit(name), f"{table.path}: column {name}"
    if dimension not in UNITS:
        return find_factor(unit, dimension, where) if unit else 1.0
    known = UNITS[dimension]
    bare = re.sub(r"[\s*·.]", "", unit)
    require(
        not unit or bare in known,
        f"{where}: {unit!r} is not a unit of {dimension} known here; use one of "
        f"{', '.join(text for text in known if text)}",
    )
    return known[bare] if unit else 1.0


def _refuse_repeats(path: str | Path, signals: list[Signal]) -> None:
    """Raise `InputError` if two columns are the same quantity at the same place."""
    seen: dict[tuple[str, float, str], str] = {}
    for signal in signals:
        place = (signal.kind, round(signal.height / NEAR) * NEAR, signal.direction)
        require(
            place not in seen,
            f"{path}: the columns {seen.get(place)} and {signal.column} are the same quantity at "
            "the same height; leave one out",
        )
        seen[place] = signal.column


def _list(names: tuple[str, ...] | list[str]) -> str:
    return ", ".join(names[:12]) + (" ..." if len(names) > 12 else "")
