"""LOWPASS and PASSIVE_OBSERVER: schemes on reported positions alone.

LOWPASS is what people use first: a low-pass filter, and the numerical derivative. A Butterworth
filter of order 2 runs over the reports as they come (a sample without one keeps the last), and the
velocity is the backward difference of its output. Its cut-off is `filters.cutoff` times the one
that balances lag and noise. Both are late by sqrt(2) over the cut-off's angular frequency, the
velocity by half a step more.

PASSIVE_OBSERVER is Fossen's non-linear passive observer, tuned by natural frequencies. The paper
compares its Kalman filters with such an observer, whose equations and gains it does not print. This
one is the public form (`owtsweep.estimation.passive_observer`). Its model knows the natural
frequencies; its cut-off is `filters.observer` times the one that balances lag and noise, and above
the waves in any case.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.passive_observer import choose_gains, find_growth, observe
from owtsweep.sensing.faults import hold_last
from owtsweep.studies.base.schemes import ByFunction, Unable
from owtsweep.studies.floater.contract import DOF, Direct, Estimates, Measured, Setting
from owtsweep.studies.floater.schemes.linear import keep_reports
from owtsweep.studies.floater.schemes.printed import find_start

#: The cut-off of LOWPASS is at most this part of the sampling frequency: a digital filter ends at
#: a half.
MOST = 0.45
#: Damping ratio of the slow motion in the observer's model.
DAMPING = 0.05
#: The observer's cut-off is above the waves by this factor at least (Fossen 2011, section 11.4).
ABOVE = 1.22
#: Radians per sample of the fastest cut-off: steps of the observer are too coarse for more.
FASTEST = 0.6


def smooth(setting: Setting, measured: Measured) -> Estimates:
    """Estimate from the reports of a record, by a low-pass filter."""
    from scipy.signal import butter, lfilter, lfilter_zi

    step = measured.step
    reported = hold_last(keep_reports(setting, measured), 0.0)
    position = np.empty_like(reported)
    best = balance_lag_and_noise(setting) / (2.0 * np.pi)
    for column, cutoff in enumerate(np.minimum(setting.tuning.cutoff * best, MOST / step)):
        b, a = butter(2, cutoff, fs=1.0 / step)
        begin = lfilter_zi(b, a) * reported[0, column]
        position[:, column] = lfilter(b, a, reported[:, column], zi=begin)[0]
    velocity = np.diff(position, axis=0, prepend=position[:1]) / step
    return Estimates(position, velocity)


def balance_lag_and_noise(setting: Setting) -> Array:
    """Return the cut-off in rad/s that is best for the velocity, shape (6,).

    A Butterworth filter of order 2 with the cut-off w is late by sqrt(2) / w, which moves the
    velocity by sqrt(2) / w times the acceleration. White noise of the variance R in reports at
    intervals h gives its derivative the variance R h w^3 / sqrt(8). The sum is least at

        w^5 = 8 sqrt(2) / 3 x sigma_a^2 / (R h)

    with the standard deviation sigma_a of the motion's acceleration.
    """
    ratio = setting.motion_sigma[2] / setting.position_sigma
    return np.asarray((8.0 * np.sqrt(2.0) / 3.0 * ratio**2 / setting.step) ** 0.2)


def find_waves(setting: Setting) -> Array:
    """Return the frequency of each degree of freedom's fast part in rad/s, shape (6,).

    That is the mean one of its velocity, or the natural one if that is higher.
    """
    mean = setting.motion_sigma[2] / setting.motion_sigma[1]
    return np.asarray(np.maximum(setting.frequency, mean))


def watch(gains: Array, setting: Setting, measured: Measured) -> Estimates:
    """Estimate from the reports of a record, by the observer with its gains, (5, 6)."""
    reported = np.ascontiguousarray(keep_reports(setting, measured))
    position, velocity = np.empty_like(reported), np.empty_like(reported)
    observe(
        reported, measured.step, setting.frequency, np.full(len(DOF), DAMPING),
        find_waves(setting), gains, find_start(reported.T)[:, 0].copy(), (position, velocity),
    )  # fmt: skip
    return Estimates(position, velocity)


def prepare_observer(setting: Setting) -> ByFunction[Setting, Measured, Estimates]:
    """Choose the gains of PASSIVE_OBSERVER; `Unable` if the observer is unstable with them."""
    waves = find_waves(setting)
    best = setting.tuning.observer * balance_lag_and_noise(setting)
    cutoff = np.clip(best, ABOVE * waves, np.maximum(FASTEST / setting.step, ABOVE * waves))
    gains = choose_gains(setting.frequency, waves, cutoff)
    for i, name in enumerate(DOF):
        growth = find_growth(setting.frequency[i], DAMPING, waves[i], gains[:, i], setting.step)
        if growth >= 1.0:
            raise Unable(
                f"PASSIVE_OBSERVER is unstable in {name} at {1.0 / setting.step:g} Hz: its error "
                f"grows by {growth:.3g} per sample; a higher record.rate or a lower "
                "filters.observer may help"
            )
    return ByFunction(partial(watch, gains), setting)


LOWPASS = Direct("LOWPASS", partial(ByFunction, smooth))
PASSIVE_OBSERVER = Direct("PASSIVE_OBSERVER", prepare_observer)
