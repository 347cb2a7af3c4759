"""Refuses settings with which a smoother or the MHE cannot work, for the schemes that have them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from owtsweep.errors import InputError, require
from owtsweep.studies.hub.sizes import check_buffers, check_horizon

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: A time counts as a multiple of a step if it is one within this fraction of the step.
GRAIN = 1e-6


def check_window(config: HubConfig, key: str, window: int) -> None:
    """Refuse a smoother's window that is longer than the record, or needs too much memory.

    `key` is the key of the window in the configuration, `window` its length in IMU steps.

    Raises
    ------
    InputError
        If so.
    """
    steps = config.record.duration * config.sensors.imu.rate
    require(
        window < steps,
        f"{key}: {window} steps are longer than the record of {steps:.0f} steps; shorten the "
        "window",
    )
    check_buffers(key, window, round(config.sensors.gnss.delay * config.sensors.imu.rate))


def check_mhe(config: HubConfig) -> None:
    """Refuse an interval, a horizon or an arrival cost with which the MHE cannot work.

    Raises
    ------
    InputError
        If there is one; the message says what would work.
    """
    mhe = config.hme.mhe
    if mhe.smoother_window is not None:
        check_window(config, "hme.mhe.smoother_window", mhe.smoother_window)
    imu, gnss = config.sensors.imu, config.sensors.gnss
    M = round(imu.rate / gnss.rate)
    steps = mhe.interval * imu.rate
    small = [d for d in range(1, math.isqrt(M) + 1) if M % d == 0]
    divisors = [*small, *(M // d for d in small)]
    if min(abs(steps - d) for d in divisors) > GRAIN * max(1.0, steps):
        low = max((d for d in divisors if d <= steps), default=1)
        high = min((d for d in divisors if d >= steps), default=M)
        values = " or ".join(f"{d / imu.rate:.10g}" for d in sorted({low, high}))
        raise InputError(
            f"hme.mhe.interval: {mhe.interval:g} s is not a whole number of IMU steps that divides "
            f"the GNSS interval {1.0 / gnss.rate:g} s; use {values}"
        )
    require(
        mhe.horizon / gnss.rate < config.record.duration,
        f"hme.mhe.horizon: {mhe.horizon} GNSS intervals ({mhe.horizon / gnss.rate:g} s) are longer "
        f"than the record of {config.record.duration:g} s; shorten the horizon",
    )
    check_horizon(mhe.horizon)
    require(
        mhe.arrival != "none" or mhe.horizon >= 2,
        "hme.mhe.arrival: 'none' needs at least 3 fixes in the window to determine position, "
        f"velocity and bias, and hme.mhe.horizon={mhe.horizon} holds {mhe.horizon + 1}; use "
        "hme.mhe.horizon=2 or more, or hme.mhe.arrival=mkf",
    )
