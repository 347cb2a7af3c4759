"""THRUST_LEVER: a thrust from one sensor, times the lever, static: what people do first.

One sensor gives the thrust: the highest inclinometer; without one the highest displacement sensor;
without one the lowest strain gauge. Its reading, over the static response of the believed turbine
on its soil to a unit thrust, is the thrust at each instant. The thrust acts at the centre of mass
of what stands on the substructure. Moments are thrust times lever, and the displacements are the
static shape. Inertia, waves and the moment of the rotor are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.tower.contract import Channel, Estimates, Scheme, Setting
from owtsweep.studies.tower.models import list_whole_dof, respond_statically, see


@dataclass(frozen=True)
class Lever:
    """The static response to a thrust, for one setting.

    Attributes
    ----------
    channel
        Number of the sensor that gives the thrust.
    per_reading
        Thrust over reading, N per unit of the channel.
    shape
        Displacements of the cut's degrees of freedom for a unit thrust, shape (dof,).
    loads
        Interface loads for a unit thrust, shape (4,).
    """

    channel: int
    per_reading: float
    shape: Array
    loads: Array

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        thrust = measured[:, self.channel] * self.per_reading
        return Estimates(np.outer(thrust, self.shape), np.outer(thrust, self.loads))


class ThrustLever(Scheme):
    """The scheme THRUST_LEVER."""

    name = "THRUST_LEVER"
    linear = True

    def prepare(self, setting: Setting) -> Lever:
        """Choose the sensor and compute the static response.

        Raises
        ------
        Unable
            If there is no sensor but accelerometers, or the sensor does not feel thrust.
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
        return Lever(
            channel=number,
            per_reading=1.0 / reading,
            shape=shape[:, 0],
            loads=np.array([-1.0, -(length + offset), 1.0, offset]),
        )


def choose_sensor(channels: tuple[Channel, ...]) -> int:
    """Return the number of the channel that gives the thrust.

    Raises
    ------
    Unable
        If all channels are accelerometers.
    """
    for kind, side in (("theta", 1), ("x", 1), ("strain", -1)):
        those = [i for i, channel in enumerate(channels) if channel.kind == kind]
        if those:
            return max(those, key=lambda i: side * channels[i].node)
    raise Unable(
        "THRUST_LEVER is blind: it needs an inclinometer, a displacement sensor or a strain gauge"
    )


SCHEME = ThrustLever()
