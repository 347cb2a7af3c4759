"""Say which roles the channels of a file can have, if those guessed for them give no record."""

from __future__ import annotations

import shlex

import numpy as np

from owtsweep.motion.recorded import Recording
from owtsweep.studies.replay.config import ReplayConfig

#: Quantity that alone gives no record -> the quantity its channels can be instead, and when.
INSTEAD = {
    "acceleration": ("specific_force", "if a level IMU measured them"),
    "fix": ("position", "if they are the motion itself and not a receiver's noisy fixes"),
}


def explain_no_motion(config: ReplayConfig, recording: Recording) -> str:
    """Return one line: there is no position, what the channels can be, and the command to type."""
    found = [quantity for quantity in INSTEAD if recording.has(quantity)]
    if not found or recording.has("specific_force"):
        return f"{recording.path}: no position: set columns.position_x and columns.position_y"
    told = f"{recording.path}: no position and no specific force"
    for quantity in found:
        role, when = INSTEAD[quantity]
        names = [recording.names[f"{quantity}_{a}"] for a in _axes(recording, quantity)]
        told += f"; {' and '.join(names)}, taken as {quantity}, can be {role}, {when}"
    if found == ["acceleration"]:
        return f"{told}, and beside fixes (columns.fix_x) or a reference (columns.reference_x)"
    kind = "an IMU and a GNSS" if "acceleration" in found else "motion"
    return f"{told}. For {kind}: {_write_command(config, recording, found[0])}"


def _write_command(config: ReplayConfig, recording: Recording, quantity: str) -> str:
    """Return the command that replays the file with the channels of `quantity` as `INSTEAD` says.

    Columns and units that the user gave are kept. Beside a specific force the rate of the fixes is
    stated, unless it is that of the configuration.
    """
    new = {f"{quantity}_{a}": f"{INSTEAD[quantity][0]}_{a}" for a in _axes(recording, quantity)}
    shown = [*new, *(f"fix_{a}" for a in _axes(recording, "fix") if f"fix_{a}" not in new)]
    columns = {**config.columns.given(), **{role: recording.names[role] for role in shown}}
    words = [f"columns.{new.get(role, role)}={name}" for role, name in columns.items()]
    words += [f"units.{new.get(role, role)}={u}" for role, u in config.units.given().items()]
    if quantity == "acceleration":
        time, value = recording.series(f"fix_{_axes(recording, 'fix')[0]}")
        came = time[np.flatnonzero(np.diff(value, prepend=np.nan))]  # a repeated fix is no new one
        step = float(np.median(np.diff(came))) if len(came) > 1 else np.inf
        imu = config.sensors.imu.rate
        rate = imu / max(round(imu * step), 1) if np.isfinite(step) else config.sensors.gnss.rate
        if rate != config.sensors.gnss.rate:
            words.append(f"sensors.gnss.rate={rate:.12g}")
    return shlex.join(["owtsweep", "replay", str(recording.path), *words])


def _axes(recording: Recording, quantity: str) -> list[str]:
    return [axis for axis in "xy" if f"{quantity}_{axis}" in recording.channels]
