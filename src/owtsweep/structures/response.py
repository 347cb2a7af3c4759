"""The answer of a structure that stands to loads that are linear between samples, exactly.

M u'' + C u' + K u = S f(t). The damping need not be proportional: dampers at one place couple the
modes. In mass-normalised modal coordinates z with the state (omega z, z'), the complex modes of the
first-order system are found, and each is advanced by the exact recursion for an input that is
linear over a step (first-order hold), as a digital filter of first order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require

#: Least square of an angular frequency over the largest that is more than rounding.
STANDS = 1e-13
#: Complex modes whose series are in memory at once.
AT_ONCE = 16


@dataclass(frozen=True)
class Outputs:
    """Which quantities are wanted: y = displacement u + velocity u' + acceleration u''.

    Each is a matrix of shape (outputs, dof), in SI units.
    """

    displacement: Array
    velocity: Array
    acceleration: Array


def respond(
    mass: Array,
    damping: Array,
    stiffness: Array,
    loads: Array,
    series: Array,
    step: float,
    wanted: Outputs,
    lead: int = 0,
) -> Array:
    """Compute outputs of a structure under loads at every sample, shape (steps - lead, outputs).

    At the first sample the structure rests as the loads of that sample bend it, so nothing jumps.
    Raise `InputError` if the structure does not stand, or buckles under its weight.

    mass, damping, stiffness: Matrices in SI units, shape (dof, dof); mass and stiffness positive
        definite.
    loads: Loads on the degrees of freedom for unit series, shape (dof, series).
    series: the series f, shape (steps, series), linear between samples, which are `step` (s) apart.
    lead: Number of samples at the beginning that are left out of the result.
    """
    from scipy.linalg import eig, eigh
    from scipy.signal import lfilter

    square, basis = eigh(stiffness, mass)
    require(
        bool(square[0] > STANDS * square[-1]),
        "structure: it does not stand (no soil, foundation or clamp), or buckles under its weight",
    )
    omega, modes = np.sqrt(square), len(square)
    damped = basis.T @ damping @ basis
    system = np.block([[np.zeros((modes, modes)), np.diag(omega)], [-np.diag(omega), -damped]])
    drive = np.vstack([np.zeros((modes, loads.shape[1])), basis.T @ loads])
    values, vectors = eig(system)
    into = np.linalg.solve(vectors, drive)  # (2 modes, series), of each complex mode
    rest = np.concatenate([(basis.T @ loads @ series[0]) / omega, np.zeros(modes)])
    start = np.linalg.solve(vectors, rest)
    # Of a conjugate pair one is enough, counted twice in the real part.
    kept = np.flatnonzero(values.imag >= 0.0)
    weight = np.where(values[kept].imag > 0.0, 2.0, 1.0)
    of_place = (basis / omega) @ vectors[:modes]
    of_speed = basis @ vectors[modes:]
    outputs = (
        wanted.displacement @ of_place
        + wanted.velocity @ of_speed
        + wanted.acceleration @ (of_speed * values)
    )[:, kept] * weight
    result = series[lead:] @ (wanted.acceleration @ (basis @ (basis.T @ loads))).T
    for first in range(0, len(kept), AT_ONCE):
        some = kept[first : first + AT_ONCE]
        # Products of real matrices: numpy would turn all of a real one into complex numbers.
        real, imaginary = series @ into[some].real.T, series @ into[some].imag.T
        states = np.empty((len(series) - lead, 2, len(some)))
        for column, mode in enumerate(some):
            now, then = _hold_linearly(values[mode], step)
            push = real[:, column] + 1j * imaginary[:, column]
            # lfilter's state before the first sample that makes its output the start
            before = np.array([start[mode] - then * push[0]])
            state = lfilter([then, now], [1.0, -np.exp(values[mode] * step)], push, zi=before)[0]
            states[:, 0, column], states[:, 1, column] = state[lead:].real, state[lead:].imag
        part = outputs[:, first : first + AT_ONCE]
        result += states.reshape(len(states), -1) @ np.hstack([part.real, -part.imag]).T
    return np.asarray(result)


def _hold_linearly(value: complex, step: float) -> tuple[complex, complex]:
    """Return the factors of the input at the beginning and at the end of a step.

    x' = value x + g with g linear over the step: x[k+1] = exp(value step) x[k] + now g[k] + then
    g[k+1].
    """
    x = value * step
    if abs(x) < 1e-3:  # the closed forms lose their digits
        held = step * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0))))
        then = step * (0.5 + x / 6.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0))))
    else:
        held = (np.exp(x) - 1.0) / value
        then = (np.exp(x) - 1.0 - x) / (value * x)
    return held - then, then
