"""The compiled Kalman filter of one degree of freedom whose acceleration is measured.

The state is position p, velocity v and the bias b of the accelerometer. The measured acceleration a
is an input, linear between samples (a first-order hold: holding it constant would shift the
velocity by half a step): p' = v, v' = a - b + noise, b' = noise. Both noises are white in
continuous time, so steps may be cut anywhere: a report of the position may show a motion between
two samples and arrive later. Rates, if measured, are those of samples, without delay.

Times are in samples, so that sample k has the time k. Sources: Kalman (1960); Anderson and Moore
(1979), section 3.1; Mehammer et al. (2018), Eqs. 6 to 9, for the model without bias.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.compiled import njit


class Noise(NamedTuple):
    """The noise of one degree of freedom.

    acceleration: intensity of the acceleration's white noise: variance per sample times sampling
        interval.
    walk: intensity of the noise that moves the bias: its change of variance per second.
    position, rate: variances of a reported position and of a measured rate.
    """

    acceleration: float
    walk: float
    position: float
    rate: float


class State(NamedTuple):
    """Position p, velocity v, bias b, and their covariance: pv is that of p and v."""

    p: float
    v: float
    b: float
    pp: float
    pv: float
    pb: float
    vv: float
    vb: float
    bb: float


@njit
def predict(s, d, first, last, noise):
    """Return the state s after d seconds, the acceleration going from `first` to `last`."""
    c = 0.5 * d * d
    p = s.p + d * s.v - c * s.b + d * d * (first / 3.0 + last / 6.0)
    v = s.v - d * s.b + 0.5 * d * (first + last)
    # F P, rows of position and velocity
    pp, pv, pb = s.pp + d * s.pv - c * s.pb, s.pv + d * s.vv - c * s.vb, s.pb + d * s.vb - c * s.bb
    vv, vb = s.vv - d * s.vb, s.vb - d * s.bb
    W, U = noise.acceleration * d, noise.walk * d
    d2 = d * d
    return State(
        p,
        v,
        s.b,
        pp + d * pv - c * pb + d2 * (W / 3.0 + U * d2 / 20.0),
        pv - d * pb + d * (W / 2.0 + U * d2 / 8.0),
        pb - U * d2 / 6.0,
        vv - d * vb + W + U * d2 / 3.0,
        vb - U * d / 2.0,
        s.bb + U,
    )


@njit
def correct(s, measured, hp, hv, variance):
    """Correct the state s by a measurement of hp p + hv v, whose noise has a `variance`.

    Return the state, the innovation and the innovation's variance.
    """
    e = measured - hp * s.p - hv * s.v
    p, v, b = hp * s.pp + hv * s.pv, hp * s.pv + hv * s.vv, hp * s.pb + hv * s.vb  # P H'
    S = hp * p + hv * v + variance
    kp, kv, kb = p / S, v / S, b / S
    corrected = State(
        s.p + kp * e,
        s.v + kv * e,
        s.b + kb * e,
        s.pp - kp * p,
        s.pv - kp * v,
        s.pb - kp * b,
        s.vv - kv * v,
        s.vb - kv * b,
        s.bb - kb * b,
    )
    return corrected, e, S


@njit
def advance(s, start, stop, acceleration, rate, step, noise):
    """Return the state s, of the time `start`, at the time `stop`, both in samples.

    The rates of the samples after `start` and until `stop` are used, but those that are NaN; `rate`
    is empty if none is measured.
    """
    j = int(start)
    time = start
    while time < stop:
        end = min(j + 1.0, stop)
        slope = acceleration[j + 1] - acceleration[j]
        first = acceleration[j] + (time - j) * slope
        last = acceleration[j] + (end - j) * slope
        s = predict(s, (end - time) * step, first, last, noise)
        j += 1
        time = end
        if end == j and len(rate) and not np.isnan(rate[j]):
            s, _, _ = correct(s, rate[j], 0.0, 1.0, noise.rate)
    return s


@njit
def write(s, estimate, covariance):
    """Write p and v of the state s into `estimate` (2,), their covariance into (2, 2)."""
    estimate[0], estimate[1] = s.p, s.v
    covariance[0, 0], covariance[0, 1] = s.pp, s.pv
    covariance[1, 0], covariance[1, 1] = s.pv, s.vv


@njit
def filter_one(position, shown, acceleration, rate, step, noise, first, start, found):
    """Filter one degree of freedom in the order in which reports arrive.

    A state is kept at the time that the newest report shows. From there, estimates are predicted to
    now. A report that shows an earlier time than one before (irregular sampling), or a time after
    its arrival, is taken as one of position and velocity at the nearest time that fits.

    position, shown: reported position and the time in samples that it shows, shape (steps,), by
        arrival; positions are NaN where no report arrives.
    acceleration, rate: measured acceleration, shape (steps,), and rate, shape (steps,) or (0,).
    step: sampling interval in s.
    first: the sample at which the first report arrives that is used.
    start: the `State` of the time that this report shows, with this report.
    found: estimates (steps, 2), their covariances (steps, 2, 2), and, where a report arrives, its
        squared innovation over its variance, shape (steps,); filled from the sample `first` on.
    """
    estimate, covariance, nis = found
    kept, known = start, shown[first]
    now = advance(kept, known, float(first), acceleration, rate, step, noise)
    write(now, estimate[first], covariance[first])
    for k in range(first + 1, len(position)):
        if np.isnan(position[k]):
            now = advance(now, k - 1.0, float(k), acceleration, rate, step, noise)
        else:
            time = min(max(shown[k], known), float(k))
            if time >= k - 1.0:  # nothing between: what is known now is all that is known
                kept, known = now, k - 1.0
            kept = advance(kept, known, time, acceleration, rate, step, noise)
            ahead = (shown[k] - time) * step
            kept, e, S = correct(kept, position[k], 1.0, ahead, noise.position)
            nis[k] = e * e / S
            known = time
            now = advance(kept, known, float(k), acceleration, rate, step, noise)
        write(now, estimate[k], covariance[k])
