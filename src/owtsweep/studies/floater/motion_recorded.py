"""Reads a recorded motion of six degrees of freedom as a truth.

Velocities and accelerations are those of a spline of degree 5 through the positions, or columns u,
v, w, p, q, r (derivatives of the six, in the basin's frame as in section 2.3) and ax, ay, az.
"""

from __future__ import annotations

import numpy as np

from owtsweep.errors import require
from owtsweep.io.reading import expand_home
from owtsweep.motion.lines import Series, Span
from owtsweep.motion.recorded import Signals, Wanted, read_signals
from owtsweep.studies.floater.config import Motion as MotionSection
from owtsweep.studies.floater.contract import DOF

#: Names of velocities and accelerations; signal -> dimension.
VELOCITIES, ACCELERATIONS = ("u", "v", "w", "p", "q", "r"), ("ax", "ay", "az")
DIMENSIONS = {
    **dict.fromkeys(DOF[:3], "length"),
    **dict.fromkeys(DOF[3:], "angle"),
    **dict.fromkeys(VELOCITIES[:3], "velocity"),
    **dict.fromkeys(VELOCITIES[3:], "angular velocity"),
    **dict.fromkeys(ACCELERATIONS, "acceleration"),
}
WANTED = Wanted("motion.columns", DIMENSIONS.get, ", ".join(DIMENSIONS), DOF)
#: Pitch in rad beyond which rates of Euler angles lose their meaning (89 degrees).
STEEPEST = np.deg2rad(89.0)


def read_file(motion: MotionSection) -> Signals:
    """Read the file of the section `motion`; errors are those of `read_signals`."""
    return read_signals(expand_home(str(motion.file)), WANTED, motion.columns)


def read_motion(
    motion: MotionSection, draws: object, span: Span, roll: float | None = None
) -> Series:
    """Read a recorded motion; before the record it rests at its first position.

    The samples of `span` are taken from the file's beginning; `draws` and `roll` are not used.

    Raises InputError if the file cannot be used, lacks a column, is too short, or has another step.
    """
    from scipy.interpolate import make_interp_spline

    steps, step, lead = span
    found = read_file(motion)
    found.require_record(1.0 / step, steps)
    values = {name: values[:steps] for name, values in found.values.items()}
    for name, each in values.items():
        require(
            bool(np.any(each != each[0])),
            f"{found.path}: {name} (channel {found.columns[name]}) is {each[0]:g} throughout, and "
            f"errors are relative to the motion of {name}; record it, or put small noise in "
            "its place",
        )
    position = np.column_stack([values[name] for name in DOF])
    steepest = float(np.abs(values["theta"]).max())
    require(
        steepest < STEEPEST,
        f"{found.path}: theta (channel {found.columns['theta']}) reaches {steepest:g} rad, where "
        "Euler angles fail; if angles are in degrees, say so: motion.columns=[phi:NAME:deg,"
        "theta:NAME:deg,psi:NAME:deg]",
    )
    time = step * np.arange(steps)
    spline = make_interp_spline(time, position, k=5)
    velocity, acceleration = np.asarray(spline(time, 1)), np.asarray(spline(time, 2))
    for names, array in ((VELOCITIES, velocity), (ACCELERATIONS, acceleration)):
        for number, name in enumerate(names):
            if name in values:
                array[:, number] = values[name]
    before = ((lead, 0), (0, 0))
    return Series(
        np.pad(position, before, "edge"), np.pad(velocity, before), np.pad(acceleration, before)
    )
