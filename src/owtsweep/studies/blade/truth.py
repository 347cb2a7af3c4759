"""The truth of a record: how the blade moves on its hook, and what ideal sensors would feel.

The centre of gravity swings and the blade turns about it: each degree of freedom is a resonance of
the hook's tackle and slow wandering in gusts, with random phases. Position, attitude, rates and
specific force are exact derivatives of each other. It is not the paper's motion, of which only
pictures are printed (Figs. 9 and 10); sizes and periods are like theirs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.estimation.inertial.angles import (
    find_body_acceleration,
    find_body_rates,
    from_heading,
    make_rotation,
)
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Series, draw_lines, find_frequencies, interpolate, respond, sample
from owtsweep.streams import Streams
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.blade.bending import make_bending, shift
from owtsweep.studies.blade.boom import make_boom
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import DOF, ROOT, UNIT, Truth
from owtsweep.studies.blade.sections import Freedom

#: Gusts end at this frequency, Hz.
GUST_END = 0.2
#: Axis of the grid -> the degree of freedom that it sets, and its key.
SET_BY_AXES = {
    "period": ("u", "period"),
    "amplitude": ("u", "sigma"),
    "heading": ("heading", "sigma"),
}


@dataclass(frozen=True)
class Motion:
    """The motion of the record with a number, `replicate`, and what came before it.

    series: Translations of the centre of gravity (m) and angles (rad) in the order of `DOF`, with
        their derivatives and `lead` samples before the record.
    bending: As of `make_bending`.
    """

    truth: Truth
    series: Series
    lead: int
    replicate: int
    bending: CubicSpline | None = None

    def locate(self, points: Array, times: Array) -> Array:
        """Return where points of the body (k, 3) are at times in s, shape (n, k, 3)."""
        place = interpolate(self.series, self.truth.step, self.lead, times)
        rotation = make_rotation(from_heading(place[:, 3:]))
        located = place[:, None, :3] + np.einsum("nij,kj->nki", rotation, points)
        if self.bending is not None:
            located += np.einsum("nij,nkj->nki", rotation, shift(self.bending, points, times))
        return np.asarray(located)


def make_truth(config: BladeConfig, replicate: int, cell: Cell) -> Motion:
    """Make the motion of a record: `replicate` says which random numbers."""
    record, draws = config.record, config.draws(replicate)
    step, steps = 1.0 / record.rate, record.steps
    late = max(max(config.grid.offset), config.sensors.prism_offset)
    lead = min(int(np.ceil(late * record.rate)) + 2, steps)
    lines = _draw_lines(config, draws, cell, find_frequencies(steps, step))
    series = sample(lines, steps, step, lead)
    x, v, a = (part[lead:] for part in series)
    angles = [from_heading(part[:, 3:]) for part in (x, v, a)]
    rotation = make_rotation(angles[0])
    rate = find_body_rates(*angles[:2])
    turning = find_body_acceleration(*angles)

    def carry(point: Array) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration of a point of the body, (steps, 3) each."""
        whirl = np.cross(rate, point)
        pull = np.cross(turning, point) + np.cross(rate, whirl)
        parts = (np.broadcast_to(point, whirl.shape), whirl, pull)
        p, u, f = (np.einsum("nij,nj->ni", rotation, part) for part in parts)
        return x[:, :3] + p, v[:, :3] + u, a[:, :3] + f

    root, root_velocity, _ = carry(ROOT)
    unit, unit_velocity, unit_acceleration = carry(UNIT)
    felt = unit_acceleration + np.array([0.0, 0.0, GRAVITY])
    truth = Truth(
        step=step,
        rotation=rotation,
        root=root,
        root_velocity=root_velocity,
        unit=unit,
        unit_velocity=unit_velocity,
        rate=rate,
        specific_force=np.einsum("nji,nj->ni", rotation, felt),
        boom=make_boom(config, draws, lines[:, :3]),
    )
    bending = make_bending(config, draws, series, steps, lead)
    return Motion(truth, series, lead, replicate, bending)


def _draw_lines(
    config: BladeConfig, draws: Streams, cell: Cell, frequency: Array
) -> NDArray[np.complex128]:
    """Draw complex amplitudes of all degrees of freedom, in m and rad, shape (lines, 6)."""
    gusts = np.where(
        (frequency > 0.0) & (frequency <= GUST_END),
        1.0 / (1.0 + (2.0 * np.pi * frequency * config.motion.gust_time) ** 2),
        0.0,
    )
    lines = np.zeros((len(frequency), len(DOF)), dtype=complex)
    for column, (name, freedom) in enumerate(choose_freedoms(config, cell).items()):
        swing = respond(frequency, freedom.period, freedom.damping)
        lines[:, column] += freedom.sigma * draw_lines(swing, draws(f"swing_{name}"))[:, 0]
        lines[:, column] += freedom.gust * draw_lines(gusts, draws(f"gust_{name}"))[:, 0]
    lines[:, 3:] *= np.pi / 180.0
    return lines


def choose_freedoms(config: BladeConfig, cell: Cell) -> dict[str, Freedom]:
    """Return all degrees of freedom in the order of `DOF`, as tugger lines and a cell have them."""
    tugger = config.motion.tugger
    chosen = {name: config.motion.freedoms[name] for name in DOF}
    for name in ("heading", "pitch"):
        chosen[name] = hold(chosen[name], getattr(tugger, name), tugger.damping)
    for axis, (name, key) in SET_BY_AXES.items():
        if axis in cell:
            chosen[name] = changed(chosen[name], **{key: cell[axis]})
    return chosen


def hold(freedom: Freedom, stiffness: float, damping: float) -> Freedom:
    """Return a freedom that tugger lines hold.

    These are ropes with winches that hold the heading and the pitch of a hanging blade, a spring
    and a damper beside those of the hook; the wind pushes as before. Then the natural frequency is
    sqrt(1 + k) times what it was, and the variance of a resonance under white noise falls with
    damping constant times stiffness, that of gusts, which are slow, with the square of the
    stiffness. `stiffness`, k, is that of the lines over that of the hook; `damping` is the ratio
    that the lines would add without their stiffness.
    """
    stiffer, damper = 1.0 + stiffness, 1.0 + damping / freedom.damping
    return changed(
        freedom,
        period=freedom.period / math.sqrt(stiffer),
        damping=freedom.damping * damper / math.sqrt(stiffer),
        sigma=freedom.sigma / math.sqrt(damper * stiffer),
        gust=freedom.gust / stiffer,
    )
