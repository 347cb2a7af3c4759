"""Where sensors are on the structure, and what they measure: signals of the truth, and noise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY
from owtsweep.sensing.faults import draw_losses
from owtsweep.sensing.noise import WienerBias
from owtsweep.streams import Streams
from owtsweep.structures.bernoulli import find_node
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.sections import KINDS, Faults, Sensors
from owtsweep.studies.tower.truth import Motion


class Place(NamedTuple):
    """Where a channel is: its kind, its node, and whether it is a GNSS receiver's."""

    kind: Kind
    node: int
    gnss: bool = False


def list_places(sensors: Sensors, nodes: Array) -> list[Place]:
    """Return the channels of each direction: displacements, rotations, accelerations, strains.

    `nodes` are heights of the nodes of the cut structure above the ground in m. Raise `InputError`
    if a sensor's height has no node.
    """
    places = []
    for name, kind in KINDS.items():
        if name in sensors.every_node:
            places += [Place(kind, node) for node in range(len(nodes))]
        places += [
            Place(kind, find_node(nodes, height, f"sensors.{name}"))
            for height in getattr(sensors, name)
        ]
    places += [
        Place("x", find_node(nodes, height, "sensors.gnss"), gnss=True) for height in sensors.gnss
    ]
    return places


def take_signals(motion: Motion, strain: Array, places: Sequence[Place], faults: Faults) -> Array:
    """Return the signals (m, rad, m/s^2, strain) of channels without noise, (steps, channels).

    motion: the truth of one direction.
    strain: Strains of the outer fibre for unit degrees of freedom, shape (nodes, dof).
    places: the channels.
    faults: whether accelerometers feel gravity and inclinometers acceleration.
    """
    signals = np.empty((len(motion.displacement), len(places)))
    for column, (kind, node, _) in enumerate(places):
        shift, turn = motion.displacement[:, 2 * node], motion.displacement[:, 2 * node + 1]
        push = motion.acceleration[:, 2 * node]
        if kind == "x":
            signals[:, column] = shift
        elif kind == "theta":
            felt = push / GRAVITY if faults.accelerated_inclinometers else 0.0
            signals[:, column] = turn - felt
        elif kind == "a":
            felt = GRAVITY * turn if faults.tilted_accelerometers else 0.0
            signals[:, column] = push - felt
        else:
            signals[:, column] = motion.displacement @ strain[node]
    return signals


def add_errors(
    signals: Array,
    sigma: Array,
    faults: Faults,
    draws: Streams,
    names: Sequence[str],
    step: float,
) -> Array:
    """Return the measurements: signals with noise and faults, shape (steps, channels).

    Each channel has streams of its own, by its name, scaled afterwards, so a larger noise is the
    same noise enlarged. `sigma` are standard deviations of the white noise, (channels,).
    """
    measured = np.empty_like(signals)
    for column, name in enumerate(names):
        signal = signals[:, column]
        size = float(np.std(signal))
        noise = draws(f"noise_{name}").standard_normal(len(signal))
        measured[:, column] = signal + sigma[column] * noise
        if faults.bias > 0.0:
            sign = np.sign(draws(f"bias_{name}").standard_normal())
            measured[:, column] += sign * faults.bias * size
        if faults.drift > 0.0:
            walk = faults.drift * size / np.sqrt(100.0)
            wander = WienerBias(draws(f"drift_{name}"), walk, step)
            measured[:, column] += wander.draw(len(signal))
        if faults.loss > 0.0:
            draw, steps = draws(f"loss_{name}"), len(signal)
            lost = draw_losses(draw, steps, faults.loss, faults.loss_length)
            kept = np.where(lost, 0, np.arange(steps))
            measured[:, column] = measured[np.maximum.accumulate(kept), column]
    return measured
