"""What makes the answer from a recorded lift doubtful, as warnings."""

from __future__ import annotations

import logging

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.blade.cases import make_lift_setting
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import Setting, Truth
from owtsweep.studies.blade.recorded_case import find_reference, load_lift

#: A longer lever arm is warned of: nothing on a blade is so far from another thing, m.
LONGEST_RECORDED = 150.0
#: By what the Earth turns, deg/s, and the bias in deg/s that a filter must assume to take it up.
EARTH_RATE, TAKEN_FOR_BIAS = 15.041 / 3600.0, 0.0042
#: The hook moves if the middle of the swing goes this many times as far as PENDULUM assumes.
FAR = 3.0

logger = logging.getLogger(__name__)


def warn_of_doubts(config: BladeConfig) -> None:
    """Log a warning of each thing that makes the answer from a recorded lift doubtful.

    An antenna too far from the inertial unit; Earth's rotation, which the filters leave out; and a
    hook that moves, if PENDULUM runs, which takes it to be at rest.
    """
    if config.recorded.imu is None:
        return
    lift = load_lift(config)
    lift.inertial.log_notes()
    setting = make_lift_setting(config, lift)
    longest = float(np.linalg.norm(setting.geometry.levers, axis=1).max())
    if longest > LONGEST_RECORDED:
        logger.warning(
            f"recorded.antennas: an antenna is {longest:g} m from the inertial unit; are the "
            "places in m?"
        )
    assumed = float(np.rad2deg(setting.rate_bias))
    if assumed < EARTH_RATE:
        key = "filters" if config.filters.noise == "declared" else "unit"
        logger.warning(
            f"{key}.rate_bias: Earth's rotation, {3600.0 * EARTH_RATE:.3g} deg/h, is left out, and "
            f"a bias of {3600.0 * assumed:.3g} deg/h (unit={config.grade}) cannot take it up, so "
            f"errors are larger than stated; set {key}.rate_bias={TAKEN_FOR_BIAS:g} (docs/blade.md)"
        )
    if "PENDULUM" in config.schemes:
        _warn_of_a_moving_hook(setting, find_reference(lift, setting))


def _warn_of_a_moving_hook(setting: Setting, truth: Truth) -> None:
    wander, assumed = find_wander(setting, truth)
    if not (wander > FAR * assumed).any():
        return
    axis = int(np.argmax(wander - FAR * assumed))
    logger.warning(
        f"PENDULUM: the hook moves by {wander[axis]:.3g} m along {'xyz'[axis]}, and PENDULUM is "
        f"for a hook at rest, assumed to wander by {assumed[axis]:.2g} m: its errors may be far "
        "larger than it states; run MEKF (docs/blade.md)"
    )


def find_wander(setting: Setting, truth: Truth) -> tuple[Array, Array]:
    """Return how far the hook goes, and how far PENDULUM assumes that it wanders, m, shape (3,).

    The hook is taken to be where the point under it is, averaged over a period of the swing; how
    far it goes is the range of that. PENDULUM's middle of the swing is a random walk
    (`schemes.swing`) that agrees with the navigation to `filters.agreement`, and its standard
    deviation at the record's end is what it assumes. The frame's horizontal axes need not be the
    blade's, so the larger of both is taken for both.
    """
    under_hook = truth.root - truth.rotation @ setting.geometry.root
    steps = len(under_hook)
    wander = np.empty(3)
    for axis, mode in enumerate(setting.swing):
        window = min(max(round(mode.period / truth.step), 1), steps)
        total = np.concatenate([[0.0], np.cumsum(under_hook[:, axis])])
        wander[axis] = np.ptp(total[window:] - total[:-window]) / window
    gusts = np.array([mode.gust for mode in setting.swing])
    assumed = gusts * np.sqrt(2.0 * steps * truth.step / setting.gust_time)
    assumed = np.hypot(assumed, setting.tuning.agreement)
    assumed[:2] = assumed[:2].max()
    return wander, assumed
