"""COMPLEMENTARY and DOUBLE_INTEGRATION: schemes whose gains do not follow from covariances.

COMPLEMENTARY has gyroscopes and gravity for the attitude, and fixes for the position.

DOUBLE_INTEGRATION takes accelerations, integrated twice, above .15 Hz, and fixes below it. It is
the chain of Maes et al. (2018), Fig. 8, for the crane's boom, and the same for the blade, whose
slow motion the fixes of one antenna show. The high-pass filter runs in both directions, so nothing
is delayed, and nothing is known before the record ends. The attitude is that of COMPLEMENTARY.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import PADDING, integrate_twice, pass_high
from owtsweep.estimation.inertial.complementary import blend_fixes, place_poles
from owtsweep.gravity import GRAVITY
from owtsweep.studies.base.schemes import ByFunction, Unable
from owtsweep.studies.blade.boom import estimate_boom
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import begin, locate_root, make_record


def complement(setting: Setting, measured: Measured) -> Estimates:
    """Run the complementary filter on a record."""
    s, _ = begin(setting)
    interval = measured.step * float(np.diff(np.flatnonzero(measured.due)).max(initial=1))
    alpha, beta = place_poles(find_crossover(setting, interval), interval)
    states = np.empty((len(measured.rate), len(s)))
    gains = (float(alpha), float(beta), 1.0 / setting.tuning.levelling)
    blend_fixes(make_record(setting, measured), gains, s, states)
    return Estimates(*locate_root(setting, measured, states))


def find_crossover(setting: Setting, interval: float) -> float:
    """Return the crossover in rad/s: (q / r)^(1/4) of white noise, as a Kalman filter has it.

    `interval` is the time between two fixes in s. q and r are the intensities of the noise of
    accelerations and of fixes. A levelled acceleration is wrong by the bias and by gravity on the
    tilt, so noise of the size of both counts as lasting as long as the levelling.
    """
    slow = setting.force_bias**2 + (GRAVITY * setting.start_sigma[2]) ** 2
    q = setting.force_sigma**2 * setting.step + 2.0 * slow * setting.tuning.levelling
    r = float(np.mean(setting.fix_sigma**2)) * interval
    return float(setting.tuning.crossover * (q / r) ** 0.25)


def integrate(setting: Setting, measured: Measured) -> Estimates:
    """Estimate from a record; `Unable` if it is not longer than the padding, or has no fix."""
    steps, step = len(measured.rate), measured.step
    geometry = setting.geometry
    if steps * step <= PADDING:
        raise Unable(f"the filter needs more than {PADDING:g} s of measurements")
    rotation = complement(setting, measured).rotation
    fixed = np.flatnonzero(np.isfinite(measured.fixes[:, 0]).all(axis=1))
    if len(fixed) == 0:
        raise Unable("there is no fix of the first antenna")
    unit = measured.fixes[fixed, 0] - rotation[fixed] @ geometry.levers[0]
    felt = np.einsum("nij,nj->ni", rotation, measured.specific_force)
    place = merge(felt - [0.0, 0.0, GRAVITY], step, fixed, unit)
    root = place + rotation @ geometry.to_root
    boom = None if measured.boom is None else estimate_boom(measured.boom)
    return Estimates(
        root=root,
        root_velocity=np.gradient(root, step, axis=0),
        rotation=rotation,
        latency=steps * step,
        boom=boom,
    )


def merge(acceleration: Array, step: float, at: NDArray[np.intp], positions: Array) -> Array:
    """Return positions (steps, 3) of accelerations (steps, 3) above .15 Hz and of fixes below it.

    Both parts add up to one: what the filter takes from the fixes is what it leaves of the
    acceleration. Fixes, at the samples `at`, are interpolated, and held before the first and after
    the last one.
    """
    time = np.arange(len(acceleration))
    slow = np.column_stack([np.interp(time, at, column) for column in positions.T])
    moved = integrate_twice(acceleration, 1.0 / step)
    return slow + pass_high(moved - slow, 1.0 / step)


COMPLEMENTARY = Direct("COMPLEMENTARY", partial(ByFunction, complement))
DOUBLE_INTEGRATION = Direct("DOUBLE_INTEGRATION", partial(ByFunction, integrate))
