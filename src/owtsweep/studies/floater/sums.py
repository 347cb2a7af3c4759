"""Kernels that judge estimates: sums of squared errors, and lags by cross-correlation."""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit


@njit
def sum_errors(position, velocity, covariance):  # pragma: no cover - compiled
    """Return means over the samples of squared errors, and of what the filter says of them.

    Errors have the shape (dof, n), the covariance of position and velocity (n, dof, 2, 2), (1, dof,
    2, 2), or (0, dof, 2, 2) if there is none. The result has the shape (dof, 5): mean squares of
    both errors, the mean of e' P^-1 e / 2, and the means of both variances in P; the last three are
    NaN without a covariance.
    """
    dof, n = position.shape
    means = np.full((dof, 5), np.nan)
    known = len(covariance)
    for i in range(dof):
        square = square_velocity = nees = variance = variance_velocity = 0.0
        for k in range(n):
            e, f = position[i, k], velocity[i, k]
            square += e * e
            square_velocity += f * f
            if known > 0:
                P = covariance[min(k, known - 1), i]
                a, b, d = P[0, 0], P[0, 1], P[1, 1]
                nees += (d * e * e - 2.0 * b * e * f + a * f * f) / (a * d - b * b)
                variance += a
                variance_velocity += d
        means[i, 0], means[i, 1] = square / n, square_velocity / n
        if known > 0:
            means[i, 2] = nees / (2.0 * n)
            means[i, 3], means[i, 4] = variance / n, variance_velocity / n
    return means


@njit
def find_lags(truth, estimate, most):  # pragma: no cover - compiled
    """Find by how many samples estimates come late, from no lag uphill to the next maximum.

    The lag is where the correlation coefficient of the truth and the shifted estimate, over the
    samples that both have, is largest; a parabola finds parts of a sample. A motion is smooth, so
    that its correlation with anything is smooth too: the walk from 0 ends at the right maximum if
    the lag is less than half a period. `owtsweep.evaluation.signals.find_lag`, which searches all
    shifts, takes 1 ms per channel.

    Both signals have the shape (channels, n) and zero mean. The result, (channels,), is negative if
    the estimate runs ahead; +-`most` if the lag is that long or longer, NaN for a channel in which
    a signal is zero.
    """
    lags = np.full(len(truth), np.nan)
    for i in range(len(truth)):
        at = correlate(truth[i], estimate[i], 0)
        if not np.isfinite(at):
            continue
        after, before = (correlate(truth[i], estimate[i], 1), correlate(truth[i], estimate[i], -1))
        shift, way = 0, 1 if after > before else -1
        while abs(shift) < most and (after if way > 0 else before) > at:
            shift += way
            onward = correlate(truth[i], estimate[i], shift + way)
            if way > 0:
                before, at, after = at, after, onward
            else:
                before, at, after = onward, before, at
        lags[i] = shift
        bend = before - 2.0 * at + after
        if abs(shift) < most and bend < 0.0:
            lags[i] += 0.5 * (before - after) / bend
    return lags


@njit
def correlate(truth, estimate, shift):  # pragma: no cover - compiled
    """Return the correlation coefficient of truth[k] and estimate[k + shift]; NaN if one is 0."""
    first, last = max(0, -shift), len(truth) - max(0, shift)
    product = power = true_power = 0.0
    for k in range(first, last):
        a, b = truth[k], estimate[k + shift]
        product += a * b
        true_power += a * a
        power += b * b
    return product / np.sqrt(true_power * power)
