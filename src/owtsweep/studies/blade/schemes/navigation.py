"""What schemes on the inertial unit share: how they begin, their priors, what they report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.strapdown import ERRORS, STATES, Record
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.blade.contract import Estimates, Measured, Setting


class Found(NamedTuple):
    """What a filter finds: states (steps, n + 1), covariances (steps, n, n), NIS sums (steps,)."""

    states: Array
    covariances: Array
    nis: Array


def begin(setting: Setting, further: Sequence[float] = ()) -> tuple[Array, Array]:
    """Return state (16,) and covariance (15, 15) of the given start.

    Further states begin at zero; `further` are their standard deviations.
    """
    (position, velocity), rotation = setting.start
    s = np.zeros(STATES + len(further))
    s[:3], s[3:6] = position, velocity
    s[6:10] = Rotation.from_matrix(rotation).as_quat(scalar_first=True)
    of_position, of_velocity, tilt, heading = setting.start_sigma
    sigma = [
        *[of_position] * 3, *[of_velocity] * 3, tilt, tilt, heading, *[setting.force_bias] * 3,
        *[setting.rate_bias] * 3, *further,
    ]  # fmt: skip
    return s, np.diag(np.square(sigma))


def make_record(setting: Setting, measured: Measured, antennas: int = 1) -> Record:
    """Return what filters get: measurements, with the noise that the setting assumes."""
    return Record(
        np.ascontiguousarray(measured.fixes[:, :antennas]),
        setting.geometry.levers[:antennas],
        np.where(measured.floating[:, None], setting.float_sigma, setting.fix_sigma) ** 2,
        measured.due,
        measured.specific_force,
        measured.rate,
        measured.step,
        find_noise(setting),
    )


def find_noise(setting: Setting) -> Array:
    """Return intensities of the noise, as of `strapdown.add_noise`."""
    return np.array([
        setting.force_sigma**2 * setting.step, setting.rate_sigma**2 * setting.step,
        setting.force_walk**2, setting.rate_walk**2,
    ])  # fmt: skip


def make_room(measured: Measured, errors: int = ERRORS) -> Found:
    steps = len(measured.rate)
    return Found(np.empty((steps, errors + 1)), np.empty((steps, errors, errors)), np.zeros(steps))


def require_antennas(setting: Setting, count: int) -> None:
    """Raise `Unable` if there are fewer antennas."""
    there = len(setting.geometry.antennas)
    if there < count:
        raise Unable(f"needs {count} antennas, and the record has {there}")


def locate_root(setting: Setting, measured: Measured, states: Array) -> tuple[Array, Array, Array]:
    """Return position and velocity of the root, (steps, 3) each, and the attitude, of states."""
    to_root = setting.geometry.to_root
    rotation = Rotation.from_quat(states[:, 6:10], scalar_first=True).as_matrix()
    whirl = np.cross(measured.rate - states[:, 13:16], to_root)
    velocity = states[:, 3:6] + np.einsum("nij,nj->ni", rotation, whirl)
    return states[:, :3] + rotation @ to_root, velocity, rotation


def report(
    setting: Setting, measured: Measured, found: Found, *, antennas: int = 1, latency: float = 0.0
) -> Estimates:
    """Return estimates of the root from states and covariances of the unit.

    The error of the root is dp - R [r]x da, with r from unit to root.
    """
    root, velocity, rotation = locate_root(setting, measured, found.states)
    lean = np.cross(setting.geometry.to_root, rotation)  # -R [r]x, row by row
    rows = np.concatenate([np.broadcast_to(np.eye(3), lean.shape), lean], axis=2)
    both = np.concatenate([np.arange(3), np.arange(6, 9)])
    P = found.covariances[:, both[:, None], both]
    seen = np.isfinite(measured.fixes[:, :antennas, 0]).any(axis=1) & measured.due
    return Estimates(
        root=root,
        root_velocity=velocity,
        rotation=rotation,
        root_covariance=rows @ P @ rows.transpose(0, 2, 1),
        attitude_covariance=P[:, 3:, 3:],
        nis=np.where(seen, found.nis, np.nan) / (3 * antennas),
        latency=latency,
    )
