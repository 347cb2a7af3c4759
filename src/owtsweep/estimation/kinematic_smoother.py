"""The compiled fixed-lag smoother of one degree of freedom whose acceleration is measured.

The model is that of `kinematic`. A first pass filters reports in the order of the times that they
show. It keeps for each sampling interval what the interval's measurements say of an error e at its
beginning: the error at its end is T e, and the scores add up to r = sum L' H' S^-1 innovation and
N = sum L' H' S^-1 H L, where L carries e to a measurement. So the estimate of a sample is corrected
by P r, and its covariance by - P N P, with r and N of the next `window` intervals (Bryson and
Frazier 1963; de Jong 1989). Intervals join like links of a chain, (T2 T1, r1 + T1' r2,
N1 + T1' N2 T1), so the sums of all windows cost a few joins per sample whatever the window is:
each window is the end of one block and the beginning of the next (van Herk 1992).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit
from owtsweep.estimation.kinematic import correct, predict


class Links(NamedTuple):
    """What intervals say of an error at their beginning.

    T, N: shape (intervals, 3, 3).
    r: shape (intervals, 3).
    """

    T: Array
    r: Array
    N: Array


@njit
def carry(T, d):
    """Carry the columns of T (3, 3), errors of p, v and b, over d seconds."""
    for i in range(3):
        T[0, i] += d * T[1, i] - 0.5 * d * d * T[2, i]
        T[1, i] -= d * T[2, i]


@njit
def learn(s, measured, hp, hv, variance, T, r, N):
    """Correct the state s as `kinematic.correct` does; add the score to r and N, correct T."""
    corrected, e, S = correct(s, measured, hp, hv, variance)
    kp = (hp * s.pp + hv * s.pv) / S
    kv = (hp * s.pv + hv * s.vv) / S
    kb = (hp * s.pb + hv * s.vb) / S
    for i in range(3):
        seen = hp * T[0, i] + hv * T[1, i]
        r[i] += seen * e / S
        for j in range(3):
            N[i, j] += seen * (hp * T[0, j] + hv * T[1, j]) / S
    for i in range(3):
        seen = hp * T[0, i] + hv * T[1, i]
        T[0, i] -= kp * seen
        T[1, i] -= kv * seen
        T[2, i] -= kb * seen
    return corrected, e * e / S


@njit
def keep(s, x, P):
    """Write the state s into x (3,) and P (3, 3)."""
    x[0], x[1], x[2] = s.p, s.v, s.b
    P[0, 0], P[0, 1], P[0, 2] = s.pp, s.pv, s.pb
    P[1, 0], P[1, 1], P[1, 2] = s.pv, s.vv, s.vb
    P[2, 0], P[2, 1], P[2, 2] = s.pb, s.vb, s.bb


@njit
def filter_in_order(position, shown, arrival, acceleration, rate, step, noise, start, out):
    """Filter reports in the order of the times that they show; return the first sample filled.

    position, shown, arrival: reports after the first, sorted by the times that they show, shape
        (reports,) each: positions, times in samples, and the samples at which they arrive.
    acceleration, rate, step, noise: as of `kinematic.filter_one`.
    start: the time in samples of the first report, and the `State` there.
    out: states (steps, 3) and their covariances (steps, 3, 3); the `Links`, zeros, that of the
        interval before sample k in row k; and squared innovations (steps,) by arrival. Filled from
        the first sample at or after the time of `start`.
    """
    x, P, links, nis = out
    time, s = start
    i = 0
    sample = int(np.ceil(time))
    beginning = sample
    if sample == time:
        keep(s, x[sample], P[sample])
        sample += 1
    for k in range(sample, len(acceleration)):
        T, r, N = links.T[k], links.r[k], links.N[k]
        for j in range(3):
            T[j, j] = 1.0
        slope = acceleration[k] - acceleration[k - 1]
        before = acceleration[k - 1]
        more = True
        while more:
            more = i < len(shown) and shown[i] <= k
            end = max(shown[i], time) if more else float(k)
            if end > time:
                first = before + (time - (k - 1)) * slope
                last = before + (end - (k - 1)) * slope
                s = predict(s, (end - time) * step, first, last, noise)
                carry(T, (end - time) * step)
                time = end
            if more:
                s, nis[arrival[i]] = learn(s, position[i], 1.0, 0.0, noise.position, T, r, N)
                i += 1
        if len(rate) and not np.isnan(rate[k]):
            s, _ = learn(s, rate[k], 0.0, 1.0, noise.rate, T, r, N)
        keep(s, x[k], P[k])
    return beginning


@njit
def join(T, r, N, later_r, later_N, out_r, out_N):
    """Write into `out_r` (3,) and `out_N` (3, 3) the sums r + T' r2 and N + T' N2 T."""
    for i in range(3):
        total = r[i]
        for j in range(3):
            total += T[j, i] * later_r[j]
        out_r[i] = total
    for i in range(3):
        a = T[0, i] * later_N[0, 0] + T[1, i] * later_N[1, 0] + T[2, i] * later_N[2, 0]
        b = T[0, i] * later_N[0, 1] + T[1, i] * later_N[1, 1] + T[2, i] * later_N[2, 1]
        c = T[0, i] * later_N[0, 2] + T[1, i] * later_N[1, 2] + T[2, i] * later_N[2, 2]
        for j in range(3):
            out_N[i, j] = N[i, j] + a * T[0, j] + b * T[1, j] + c * T[2, j]


@njit
def multiply(A, B, out):
    """Write the product A B of matrices (3, 3) into `out`, which is neither of them."""
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@njit
def look_ahead(x, P, links, begin, window, estimate, covariance):
    """Correct the states of samples by what the `window` intervals after them say.

    x, P: filtered states (steps, 3) and their covariances (steps, 3, 3).
    links: `Links`, that of the interval before sample k in row k.
    begin: the first sample to smooth.
    window: number of intervals; less at the record's end.
    estimate, covariance: of position and velocity, (steps, 2) and (steps, 2, 2); overwritten from
        `begin` on.
    """
    steps = len(x)
    # From each sample of a block to the block's end, and from there on.
    size = window + 1
    block = Links(np.zeros((size, 3, 3)), np.zeros((size, 3)), np.zeros((size, 3, 3)))
    T, next_T, N, next_N = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    r, next_r = np.empty(3), np.empty(3)
    for first in range(begin, steps, max(window, 1)):
        end = min(first + window, steps - 1)
        block.T[end - first] = np.eye(3)
        block.r[end - first] = 0.0
        block.N[end - first] = 0.0
        for k in range(end - 1, first - 1, -1):
            i = k - first
            join(
                links.T[k + 1], links.r[k + 1], links.N[k + 1],
                block.r[i + 1], block.N[i + 1], block.r[i], block.N[i],
            )  # fmt: skip
            multiply(block.T[i + 1], links.T[k + 1], block.T[i])
        T[:], r[:], N[:] = np.eye(3), 0.0, 0.0
        for k in range(first, min(first + max(window, 1), steps)):
            i = k - first
            if i > 0 and k + window < steps:
                m = k + window
                join(T, r, N, links.r[m], links.N[m], next_r, next_N)
                multiply(links.T[m], T, next_T)
                r[:], N[:], T[:] = next_r, next_N, next_T
            join(block.T[i], block.r[i], block.N[i], r, N, next_r, next_N)
            smooth(x[k], P[k], next_r, next_N, estimate[k], covariance[k])


@njit
def smooth(x, P, r, N, estimate, covariance):
    """Write x + P r and P - P N P of position and velocity."""
    for i in range(2):
        estimate[i] = x[i] + P[i, 0] * r[0] + P[i, 1] * r[1] + P[i, 2] * r[2]
        a = P[i, 0] * N[0, 0] + P[i, 1] * N[1, 0] + P[i, 2] * N[2, 0]
        b = P[i, 0] * N[0, 1] + P[i, 1] * N[1, 1] + P[i, 2] * N[2, 1]
        c = P[i, 0] * N[0, 2] + P[i, 1] * N[1, 2] + P[i, 2] * N[2, 2]
        for j in range(2):
            covariance[i, j] = P[i, j] - a * P[0, j] - b * P[1, j] - c * P[2, j]
