"""What sensors on the structure measure: signals of the truth, and their noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import NotNegative, Section, key
from owtsweep.gravity import GRAVITY
from owtsweep.sensing.faults import Losses
from owtsweep.sensing.noise import WienerBias
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.truth import Motion


class Faults(Section):
    """The section `faults`: what is wrong with sensors besides white noise, told to no scheme.

    Sizes are parts of each channel's own standard deviation.
    """

    bias: NotNegative = key("constant offset, with a random sign", default=0.0)
    drift: NotNegative = key("Wiener process: its standard deviation after 100 s", default=0.0)
    loss: float = key(
        "probability that an outage begins at a sample; lost samples repeat the last one",
        default=0.0,
        ge=0.0,
        lt=1.0,
    )
    loss_length: int = key("of an outage, in samples", default=100, ge=1)
    tilted_accelerometers: bool = key("whether accelerometers read a - g theta", default=False)
    accelerated_inclinometers: bool = key("whether inclinometers read theta - a/g", default=False)


def take_signals(
    motion: Motion, strain: Array, channels: Sequence[tuple[Kind, int]], faults: Faults
) -> Array:
    """Return the signals of channels without noise.

    Parameters
    ----------
    motion
        The truth of one direction.
    strain
        Strains of the outer fibre for unit degrees of freedom, shape (nodes, dof).
    channels
        Kind and node of each channel.
    faults
        Whether accelerometers feel gravity and inclinometers acceleration.

    Returns
    -------
    array
        Signals in m, rad, m/s^2 or strain, shape (steps, channels).
    """
    signals = np.empty((len(motion.displacement), len(channels)))
    for column, (kind, node) in enumerate(channels):
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
    stream: Callable[[str], np.random.Generator],
    names: Sequence[str],
    step: float,
) -> Array:
    """Return the measurements: signals with noise and faults.

    Each channel has streams of its own, scaled afterwards, so a larger noise is the same noise
    enlarged.

    Parameters
    ----------
    signals
        Shape (steps, channels).
    sigma
        Standard deviations of the white noise, shape (channels,).
    faults
        The section `faults`.
    stream
        Function that returns a new random generator, given a name.
    names
        Names of the channels, for the streams.
    step
        Sampling interval in s.
    """
    measured = np.empty_like(signals)
    for column, name in enumerate(names):
        signal = signals[:, column]
        size = float(np.std(signal))
        noise = stream(f"noise_{name}").standard_normal(len(signal))
        measured[:, column] = signal + sigma[column] * noise
        if faults.bias > 0.0:
            sign = np.sign(stream(f"bias_{name}").standard_normal())
            measured[:, column] += sign * faults.bias * size
        if faults.drift > 0.0:
            walk = faults.drift * size / np.sqrt(100.0)
            wander = WienerBias(stream(f"drift_{name}"), walk, step)
            measured[:, column] += wander.draw(len(signal))
        if faults.loss > 0.0:
            lost = Losses(stream(f"loss_{name}"), faults.loss, faults.loss_length)
            kept = np.where(lost.draw(len(signal)), 0, np.arange(len(signal)))
            measured[:, column] = measured[np.maximum.accumulate(kept), column]
    return measured
