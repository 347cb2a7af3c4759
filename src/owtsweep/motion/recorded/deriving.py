"""Derive velocity and acceleration from recorded positions, as far as they are above noise."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded import gridding
from owtsweep.motion.recorded.recording import Recording

#: Highest default cut-off of motion, Hz. It lies above the first two bending modes of a tower, and
#: is low enough to keep rounding and noise small, which grow as f^2 in the acceleration.
MOTION_CUTOFF = 5.0
#: Samples of a segment of Welch's method, and of a long record that it takes, the first ones.
SEGMENT, MOST_SAMPLES = 512, 100_000
#: The motion stands out where the density is this many times that of the noise.
CLEAR = 4.0


def to_motion(
    recording: Recording,
    rate: float,
    *,
    quantity: str = "position",
    orders: int = 3,
    cutoff: float | None = None,
    grid: gridding.TimeGrid | None = None,
) -> gridding.Gridded:
    """Compute position, velocity and acceleration on a grid from recorded positions.

    All three are derivatives of one band-limited function through the positions. Recorded
    velocities or accelerations take their place beside "position". An axis without positions stays
    at rest.

    recording: a checked recording.
    rate: of the grid, Hz; not used if `grid` is given.
    quantity: what holds the positions: "position" or "reference", which is NaN in its long gaps.
    orders: 1 for the position only, 2 for position and velocity, 3 for the acceleration too.
    cutoff: Hz; by default 5 Hz, or 0.4 of the rate of recording or grid if this is less.
    grid: by default it covers the time that the recorded axes have in common.
    Raises InputError if the recording lacks the quantity, the cut-off is above 0.4 of one of the
        two rates, or the grid would be shorter than 1 s or have too many steps.
    """
    roles = [f"{quantity}_{axis}" for axis in "xy" if f"{quantity}_{axis}" in recording.channels]
    if not roles:
        raise InputError(
            f"{recording.path}: no {quantity}: set columns.{quantity}_x and columns.{quantity}_y"
        )
    grid = grid or gridding.find_common_grid(recording, roles, rate)
    sources = {role: gridding.make_uniform(recording, role) for role in roles}
    rates = [grid.rate, *(1.0 / comb.step for _, comb, _ in sources.values())]
    highest = gridding.FULL_BAND * min(rates)
    chosen = min(highest, MOTION_CUTOFF) if cutoff is None else cutoff
    if not 0.0 < chosen <= highest * (1 + 1e-9):
        raise InputError(
            f"{recording.path}: replay.cutoff: {chosen:g} Hz is not between 0 and {highest:.4g} "
            "Hz, which is 0.4 of the lower of two rates, the record's and the IMU's"
        )
    names = ("position", "velocity", "acceleration")[:orders]
    pairs = {name: np.zeros((grid.steps, 2)) for name in names}
    notes = [f"motion kept up to {chosen:.4g} Hz, nothing above {1.25 * chosen:.4g} Hz"]
    for column, axis in enumerate("xy"):
        role = f"{quantity}_{axis}"
        if role not in sources:
            notes.append(f"no {role}: that axis is at rest")
            continue
        values, comb, holes = sources.pop(role)
        function = gridding.BandLimited(values, comb.start, comb.step, chosen, grid.rate)
        del values
        for order, name in enumerate(names):
            given = f"{name}_{axis}"
            derived = function.on_grid(grid.start, grid.rate, grid.steps, order)
            if quantity == "position" and order > 0 and given in recording.channels:
                recorded = gridding.to_grid(recording, given, grid)
                notes.append(_describe_mismatch(given, recorded, derived))
                derived = recorded
            if quantity == "reference" and holes:
                derived[gridding.mark_inside(grid.time, holes)] = np.nan
            pairs[name][:, column] = derived
    return gridding.Gridded(grid, pairs, chosen, tuple(notes))


def _describe_mismatch(role: str, recorded: Array, derived: Array) -> str:
    inner = slice(len(derived) // 20, len(derived) - len(derived) // 20)
    apart = float(np.sqrt(np.mean((recorded - derived)[inner] ** 2)))
    size = float(np.std(derived[inner]))
    share = f"{100 * apart / size:.3g} % of its rms" if size > 0 else f"{apart:.3g}"
    return f"{role} taken as recorded; it differs from the derivative of the positions by {share}"


def find_clear_band(recording: Recording, rate: float) -> float:
    """Return the frequency (Hz) above `MOTION_CUTOFF` up to which a reference is mostly motion.

    The noise is taken as white: its density is the median above 0.4 of the sampling rate. The
    result is that of the axis with the widest band; `MOTION_CUTOFF` with fewer than 512 samples. It
    is at most 0.4 of the lower of two rates, the record's and `rate`.
    """
    from scipy.signal import welch

    found = MOTION_CUTOFF
    for role in (role for role in recording.channels if role.startswith("reference")):
        rate = min(rate, recording.rate(role))
        values, comb, _ = gridding.make_uniform(recording, role)
        highest = gridding.FULL_BAND / comb.step
        if highest <= MOTION_CUTOFF or len(values) < SEGMENT:
            continue
        used = values[:MOST_SAMPLES]
        frequency, density = welch(used, 1.0 / comb.step, nperseg=SEGMENT, detrend="linear")
        noise = np.median(density[frequency > highest])
        kept = (frequency > MOTION_CUTOFF) & (frequency <= highest)
        drowned = np.flatnonzero(kept & (density <= CLEAR * noise))
        clear = frequency[drowned[0] - 1] if len(drowned) else highest
        found = max(found, float(clear))
    return min(found, gridding.FULL_BAND * rate)
