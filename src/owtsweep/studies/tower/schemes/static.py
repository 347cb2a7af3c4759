"""QUASI_STATIC and THRUST_LEVER: static shapes through few sensors, without inertia.

QUASI_STATIC: the substructure is bent by force and moment at its upper cut, which force and moment
at the lower one balance; it leans as a rigid body by what the soil yields. Rotation and both loads
follow from inclinometers (and displacement sensors and strain gauges, if there are any) by weighted
least squares, one instant at a time. Neither soil nor rotor is modelled. Without a displacement
sensor the ground stays in place.

THRUST_LEVER: a thrust from one sensor, times the lever: what people do first. One sensor gives the
thrust: the highest inclinometer; without one the highest displacement sensor; without one the
lowest strain gauge. Its reading, over the static response of the assumed turbine on its soil to a
unit thrust, is the thrust at each instant. The thrust acts at the centre of mass of what stands on
the substructure. Moments are thrust times lever, and the displacements are the static shape.
Inertia, waves and the moment of the rotor are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.tower.contract import SOIL, Channel, Direct, Estimates, Setting
from owtsweep.studies.tower.models import (
    decompose,
    list_whole_dof,
    move_rigidly,
    respond_statically,
    see,
)


@dataclass(frozen=True)
class Shapes:
    """Static shapes and what the sensors say of them, for one setting.

    `decompose`: coordinates of the shapes for unit signals, shape (shapes, channels). `shapes`:
    displacements of the cut's degrees of freedom for unit coordinates, shape (dof, shapes).
    `loads`: interface loads for unit coordinates, shape (4, shapes).
    """

    decompose: Array
    shapes: Array
    loads: Array

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        coordinates = measured @ self.decompose.T
        return Estimates(coordinates @ self.shapes.T, coordinates @ self.loads.T)


def prepare_shapes(setting: Setting) -> Shapes:
    """Compute static shapes, and their coordinates from sensors.

    Raise `Unable` if the sensors do not tell the shapes apart.
    """
    cut, channels = setting.cut, setting.channels
    height = cut.heights[-1] - cut.heights[0]
    shapes = np.zeros((len(cut.mass), 4))
    shapes[:, :2] = move_rigidly(cut)
    unit = np.eye(len(cut.mass) - 2)
    shapes[2:, 2:] = np.linalg.solve(cut.stiffness[2:, 2:], unit[:, -2:])  # the ground held
    loads = np.zeros((4, 4))
    loads[:, 2] = [-1.0, -height, 1.0, 0.0]
    loads[:, 3] = [0.0, -1.0, 0.0, 1.0]
    if not any(channel.kind == "x" for channel in channels):
        shapes, loads = shapes[:, 1:], loads[:, 1:]  # no sensor feels translation
    weight = np.array([0.0 if each.kind == "a" else 1.0 / each.sigma for each in channels])
    rank, coordinates = decompose(channels, weight, shapes, setting.strain)
    if rank < shapes.shape[1]:
        raise Unable(
            f"QUASI_STATIC is blind: its sensors (accelerometers do not count) see {rank} of "
            f"{shapes.shape[1]} static shapes; it needs inclinometers at "
            f"{shapes.shape[1]} heights"
        )
    return Shapes(coordinates, shapes, loads)


def prepare_lever(setting: Setting) -> Shapes:
    """Choose the sensor and compute the static response: one shape, whose size is the thrust.

    Raise `Unable` if there is no sensor but accelerometers, or the sensor does not feel thrust.
    """
    whole, at = setting.whole, list_whole_dof(setting)
    standing = whole.mass[np.ix_(at[-2:], at[-2:])] - setting.cut.mass[-2:, -2:]
    offset = standing[0, 1] / standing[0, 0] if standing[0, 0] > 0.0 else 0.0
    thrust = np.zeros((len(whole.mass), 1))
    thrust[at[-2:], 0] = [1.0, offset]
    shape = respond_statically(whole, thrust)[at]
    number = choose_sensor(setting.channels)
    reading = see(setting.channels[number], shape, setting.strain)[0]
    if abs(reading) <= 1e-12 * np.abs(shape).max():
        raise Unable("THRUST_LEVER is blind: its sensor does not feel thrust")
    length = setting.cut.heights[-1] - setting.cut.heights[0]
    per_signal = np.zeros((1, len(setting.channels)))
    per_signal[0, number] = 1.0 / reading
    return Shapes(per_signal, shape, np.array([[-1.0], [-(length + offset)], [1.0], [offset]]))


def choose_sensor(channels: tuple[Channel, ...]) -> int:
    """Return the number of the channel that gives the thrust.

    Raise `Unable` if all channels are accelerometers.
    """
    for kind, side in (("theta", 1), ("x", 1), ("strain", -1)):
        those = [i for i, channel in enumerate(channels) if channel.kind == kind]
        if those:
            return max(those, key=lambda i: side * channels[i].node)
    raise Unable(
        "THRUST_LEVER is blind: it needs an inclinometer, a displacement sensor or a strain gauge"
    )


QUASI_STATIC = Direct("QUASI_STATIC", prepare_shapes, SOIL)
THRUST_LEVER = Direct("THRUST_LEVER", prepare_lever)
