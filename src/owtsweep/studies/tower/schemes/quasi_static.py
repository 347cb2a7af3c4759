"""QUASI_STATIC: static shapes of the substructure through the inclinometers, without inertia.

The substructure is bent by force and moment at its upper cut, which force and moment at the lower
one balance; it leans as a rigid body by what the soil yields. Rotation and both loads follow from
inclinometers (and displacement sensors and strain gauges, if there are any) by weighted least
squares, one instant at a time. Neither soil nor rotor is modelled. Without a displacement sensor
the ground stays in place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.tower.contract import Estimates, Scheme, Setting
from owtsweep.studies.tower.models import see


@dataclass(frozen=True)
class Shapes:
    """Static shapes and what the sensors say of them, for one setting.

    Attributes
    ----------
    decompose
        Coordinates of the shapes for unit signals, shape (shapes, channels).
    shapes
        Displacements of the cut's degrees of freedom for unit coordinates, shape (dof, shapes).
    loads
        Interface loads for unit coordinates, shape (4, shapes).
    """

    decompose: Array
    shapes: Array
    loads: Array

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        coordinates = measured @ self.decompose.T
        return Estimates(coordinates @ self.shapes.T, coordinates @ self.loads.T)


class QuasiStatic(Scheme):
    """The scheme QUASI_STATIC."""

    name = "QUASI_STATIC"
    linear = True

    def prepare(self, setting: Setting) -> Shapes:
        """Compute static shapes, and their coordinates from sensors.

        Raises
        ------
        Unable
            If the sensors do not tell the shapes apart.
        """
        cut, channels = setting.cut, setting.channels
        height = cut.heights - cut.heights[0]
        shapes = np.zeros((len(cut.mass), 4))
        shapes[0::2, 0] = 1.0
        shapes[0::2, 1], shapes[1::2, 1] = height, 1.0
        force = np.zeros((len(cut.mass) - 2, 2))
        force[-2:] = np.eye(2)
        shapes[2:, 2:] = np.linalg.solve(cut.stiffness[2:, 2:], force)  # the ground held
        loads = np.zeros((4, 4))
        loads[:, 2] = [-1.0, -height[-1], 1.0, 0.0]
        loads[:, 3] = [0.0, -1.0, 0.0, 1.0]
        if not any(channel.kind == "x" for channel in channels):
            shapes, loads = shapes[:, 1:], loads[:, 1:]  # no sensor feels translation
        seen = np.zeros((len(channels), shapes.shape[1]))
        weight = np.zeros(len(channels))
        for row, channel in enumerate(channels):
            if channel.kind != "a":
                weight[row] = 1.0 / channel.sigma
                seen[row] = see(channel, shapes, setting.strain) * weight[row]
        size = np.linalg.norm(seen, axis=0)
        size[size == 0.0] = 1.0
        rank = int(np.linalg.matrix_rank(seen / size))
        if rank < shapes.shape[1]:
            raise Unable(
                f"QUASI_STATIC is blind: its sensors (accelerometers do not count) see {rank} of "
                f"{shapes.shape[1]} static shapes; it needs inclinometers at "
                f"{shapes.shape[1]} heights"
            )
        return Shapes(np.linalg.pinv(seen / size) * weight / size[:, None], shapes, loads)


SCHEME = QuasiStatic()
