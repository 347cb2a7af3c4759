"""Motion of a structure's hub under irregular waves: the plant of Ren et al. (2019), section 2.

The structure's modes answer to the waves' loads. Loads act on the structure at rest, in the
direction of the waves, and the structure is symmetric, so the hub moves along that direction. The
answer is the steady one: it repeats with the waves, and a record is the first half of the period.

There is no wind. On the parked tower without blades its gusts at the first natural frequency move
the hub by some millimetres (docs/plant.md has the estimate), against .1 to .3 m by the waves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.motion.source import Motion, interleaved
from owtsweep.streams import Streams
from owtsweep.structures import Modes, Structure, compute_modes
from owtsweep.waves import Cylinder, Sea, drag_force, draw_waves, inertia_force

#: Points of the Gauss rule over the depth; they crowd where waves are strongest, at the surface.
DEPTH_POINTS = 24
#: Highest frequency (Hz) of loads and motion: drag has overtones of the waves, which reach 1 Hz.
HIGHEST = 2.0
#: Samples per second at which drag is computed: twice the highest frequency, and some room.
DRAG_RATE = 5.0


@dataclass(frozen=True)
class Plant:
    """A source of hub motion along the waves: a structure in a sea.

    `structure`: the structure; it must stand in water. `blades`: number of mounted blades. `modes`:
    number of modes that answer.
    """

    structure: Structure
    sea: Sea
    blades: int = 0
    modes: int = 4
    streams: ClassVar[tuple[str, ...]] = ("phase",)
    duration: ClassVar[None] = None

    def __post_init__(self) -> None:
        require(
            self.structure.water is not None and self.structure.mudline < 0.0,
            f"structure {self.structure.name}: it does not stand in water; give structure.water "
            "and a mudline below 0",
        )
        require(
            self.structure.bottom <= self.structure.mudline and self.structure.hub >= 0.0,
            f"structure {self.structure.name}: its tubes reach from {self.structure.bottom:g} to "
            f"{self.structure.hub:g} m, but waves need one from the mudline to above the water",
        )

    @cached_property
    def vibration(self) -> Modes:
        """The modes of the structure with its blades."""
        return compute_modes(self.structure, self.modes, self.blades)

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Draw one record of any length, as `Source.realise` says; the stream is "phase".

        What is felt is a - g theta, with the hub's rotation theta in rad: positive if it leans the
        way that positions count.

        Raise `InputError` if the record is too short for waves, or the structure has no such modes.
        """
        period = 2 * steps * step
        require(
            step < 0.5 / HIGHEST,
            f"sensors.imu.rate: {1.0 / step:g} Hz must be above {2.0 * HIGHEST:g} Hz, because "
            f"the plant moves at up to {HIGHEST:g} Hz",
        )
        heights, forces = draw_forces(self.structure, self.sea, stream("phase"), period)
        answer = respond(self.vibration, heights, forces, period)
        hub = answer.sum(axis=0)
        speed = 2j * np.pi * np.arange(len(hub)) / period

        def sample(bins: NDArray[np.complex128], newest: int = 0) -> tuple[Array, Array]:
            whole = interleaved(bins, 2 * steps).T.reshape(-1)
            return whole[:steps].copy(), whole[len(whole) - newest :].copy()

        position, before = sample(hub, history)
        velocity, acceleration = sample(hub * speed)[0], sample(hub * speed**2)[0]
        slope = sample(self.vibration.slope @ answer)[0]
        felt = acceleration - self.structure.gravity * slope
        return Motion(step, position, velocity, acceleration, before, felt)


def draw_forces(
    structure: Structure, sea: Sea, phase: np.random.Generator, period: float
) -> tuple[Array, NDArray[np.complex128]]:
    """Draw the forces of waves on a structure at rest, at some heights from sea bed to surface.

    The forces depend on tubes and water alone: soil and blades change none of them. They repeat
    after `period`, s. Raise `InputError` if it is too short for waves.

    Return heights in m, shape (heights,), and complex amplitudes of the forces in N, shape
    (heights, lines from 0 on), line m at the frequency m / period.
    """
    water = structure.water
    assert water is not None  # a Plant has checked it
    depth = -structure.mudline
    waves = draw_waves(sea, phase, period=period, depth=depth, gravity=structure.gravity)
    bins = int(HIGHEST * period) + 1
    count = 2 * int(np.ceil(0.5 * DRAG_RATE * period))
    lines = np.zeros(count // 2 + 1, dtype=complex)
    heights, lengths = _depth_rule(depth)
    forces = np.empty((len(heights), bins), dtype=complex)
    for row, (height, length) in enumerate(zip(heights, lengths, strict=True)):
        tube = next(t for t in structure.tubes if t.bottom <= height <= t.top)
        diameter = float(tube.outer(np.array(height)))
        cylinder = Cylinder(diameter, water.density, water.drag)
        lines[:] = 0.0
        lines[waves.numbers] = waves.velocity(height)
        velocity = np.fft.irfft(lines * (0.5 * count), count)
        force = np.fft.rfft(drag_force(velocity, cylinder))[:bins] * (2.0 / count)
        force[waves.numbers] += inertia_force(waves, cylinder, height)
        forces[row] = length * force
    return heights, forces


def respond(
    modes: Modes, heights: Array, forces: NDArray[np.complex128], period: float
) -> NDArray[np.complex128]:
    """Compute the hub's steady displacement in each mode under the forces of `draw_forces`.

    The forces repeat after `period`, s. Return complex amplitudes in m, shape (modes, lines).
    """
    loads = np.zeros((len(modes.frequency), forces.shape[1]), dtype=complex)
    for shape, force in zip(modes.at(heights), forces, strict=True):
        loads += shape[:, None] * force
    loads[:, 0] = 0.0  # the mean of the drag is a static deflection, not motion
    omega = 2.0 * np.pi * np.arange(loads.shape[1]) / period
    own = 2.0 * np.pi * modes.frequency[:, None]
    impedance = modes.mass[:, None] * (own**2 - omega**2 + 2j * modes.damping * own * omega)
    return np.asarray(loads / impedance)


def _depth_rule(depth: float) -> tuple[Array, Array]:
    """Return heights (m) and lengths (m) of a Gauss rule from the sea bed to the surface.

    With z = -depth s^2 the points of a rule in s crowd at the surface.
    """
    nodes, weights = np.polynomial.legendre.leggauss(DEPTH_POINTS)
    s, w = 0.5 * (nodes + 1.0), 0.5 * weights
    return -depth * s**2, 2.0 * depth * s * w
