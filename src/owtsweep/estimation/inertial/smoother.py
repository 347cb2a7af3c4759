"""The compiled smoother behind the multiplicative filter of inertial navigation.

It carries what later fixes say back through the linear model of the errors (Rauch, Tung and
Striebel 1965), with the difference of two states as of `strapdown.subtract`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    GYROSCOPES,
    add_noise,
    carry,
    correct,
    linearise,
    move,
    subtract,
)


@njit
def link(states, covariances, record, links):
    """Compute how each sample follows from what later ones say.

    states, covariances: of the filter, shapes (steps, 16) and (steps, 15, 15).
    record: a `strapdown.Record`.
    links: filled for all samples but the last: the predicted states of the next sample (steps, 16),
        their covariances (steps, 15, 15), and the smoother's gains, in the same shape.
    """
    _, _, _, _, force, rate, step, noise = record
    predicted, predicted_P, gains = links
    old, new = np.empty((3, 3)), np.empty((3, 3))
    M, R, back = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(len(states) - 1):
        moved = states[k].copy()
        mean = 0.5 * (rate[k] + rate[k + 1])
        move(moved, step, force[k], force[k + 1], mean, GYROSCOPES, old, new)
        linearise(moved, force[k], force[k + 1], old, new, M, R, back)
        across = covariances[k].copy()
        carry(across, step, M, R, back, GYROSCOPES)
        P = across.copy()
        carry(P.T, step, M, R, back, GYROSCOPES)
        add_noise(P, step, noise)
        predicted[k], predicted_P[k] = moved, P
        gains[k] = np.linalg.solve(P, across).T


@njit
def carry_back(s, P, state, covariance, predicted, predicted_P, gain):
    """Carry the smoothed state s (16,) and covariance P of a sample to the one before, in place.

    `state` and `covariance` are the filter's at the sample before, the others those of `link`.
    """
    dx = np.empty(ERRORS)
    subtract(s, predicted, dx)
    dx = gain @ dx
    change = gain @ (P - predicted_P) @ gain.T
    s[:] = state
    correct(s, dx)
    P[:] = covariance + 0.5 * (change + change.T)


@njit
def smooth_lag(states, covariances, links, due, lag, out):
    """Smooth each sample by the fixes up to `lag` samples after it, or a little more.

    A pass back begins at each sample at which a fix is due, so a sample waits for the first of
    these that is `lag` samples or more after it. The last samples wait for the record's end. With
    a lag as long as the record, each sample is smoothed by all fixes.

    states, covariances, links: as `link` takes and fills them.
    due: whether a fix is due at a sample, lost or not, shape (steps,).
    out: filled: smoothed states and covariances, shapes (steps, 16) and (steps, 15, 15).
    """
    predicted, predicted_P, gains = links
    smoothed, smoothed_P = out
    smoothed[:], smoothed_P[:] = states, covariances
    last = len(states) - 1
    done = 0  # samples before this one are smoothed
    for k in range(last + 1):
        until = last if k == last else k - lag
        if until < done or not (due[k] or k == last):
            continue
        s, P = states[k].copy(), covariances[k].copy()
        for j in range(k - 1, done - 1, -1):
            carry_back(s, P, states[j], covariances[j], predicted[j], predicted_P[j], gains[j])
            if j <= until:
                smoothed[j], smoothed_P[j] = s, P
        done = until + 1
