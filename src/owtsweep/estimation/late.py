"""The compiled covariance recursion of a filter whose slow measurement reports a past output.

The model is one axis of a motion that a shaping filter makes of white noise, seen by a fast sensor
at every step and by a slow sensor every `interval` steps. The slow measurement reports the output
of `delay` steps before its arrival. So the state keeps a copy of each output whose report is still
to come: a copy is correlated with the state like the output itself, and the late measurement is
applied to the copy exactly. The method is stochastic cloning (Roumeliotis and Burdick 2002).

The state of N numbers is: the n states of the shaping filter, the bias of the fast sensor, and the
copies, the newest first.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit


@njit
def predict_covariance(model, P):
    """Replace the covariance P (N, N) of a step by the predicted covariance of the next step.

    Rounding errors make P slightly asymmetric; call `symmetrise` once in a while.
    """
    A, Q = model.A, model.Q
    n, N = len(Q), len(P)
    for i in range(0, n, 2):
        block = A[i // 2]
        a, b, c, d = block[0, 0], block[0, 1], block[1, 0], block[1, 1]
        for j in range(N):
            first, second = P[i, j], P[i + 1, j]
            P[i, j] = a * first + b * second
            P[i + 1, j] = c * first + d * second
    for i in range(N):
        for block in range(n // 2):
            j = 2 * block
            first, second = P[i, j], P[i, j + 1]
            P[i, j] = A[block, 0, 0] * first + A[block, 0, 1] * second
            P[i, j + 1] = A[block, 1, 0] * first + A[block, 1, 1] * second
    for i in range(n):
        for j in range(n):
            P[i, j] += Q[i, j]
    P[n, n] += model.walk


@njit
def symmetrise(P):
    """Replace a covariance P (N, N) by the mean of it and its transpose."""
    for i in range(len(P)):
        for j in range(i):
            mean = 0.5 * (P[i, j] + P[j, i])
            P[i, j] = mean
            P[j, i] = mean


@njit
def correct_covariance(P, gain, variance):
    """Correct the covariance P (N, N) by a measurement of one number.

    Parameters
    ----------
    P
        The covariance before the measurement; overwritten by the covariance after it.
    gain
        The column P h' (N,), where h is the measurement's row; overwritten by the gain.
    variance
        The innovation's variance h P h' + r.
    """
    N, root = len(P), np.sqrt(variance)
    for i in range(N):
        gain[i] /= root
    for i in range(N):
        scale = gain[i]
        for j in range(N):
            P[i, j] -= scale * gain[j]
    for i in range(N):
        gain[i] /= root


@njit
def write_outputs(P, outputs, work, result):
    """Write the covariance of c outputs of a state with the covariance P (N, N) to `result` (c, c).

    `outputs` are the rows (c, n) of the outputs; `work` is an array (n,) that is overwritten.
    """
    count, n = outputs.shape
    for b in range(count):
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += P[i, j] * outputs[b, j]
            work[i] = total
        for a in range(b + 1):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * work[i]
            result[a, b] = total
            result[b, a] = total


@njit
def apply_fast(model, P, gain):
    """Correct the covariance P (N, N) by the fast measurement; write its gain to `gain` (N,)."""
    n, N, row = len(model.Q), len(P), model.fast
    for i in range(N):
        total = P[i, n]
        for j in range(n):
            total += P[i, j] * row[j]
        gain[i] = total
    variance = model.r_fast + gain[n]
    for i in range(n):
        variance += row[i] * gain[i]
    correct_covariance(P, gain, variance)


@njit
def apply_slow(model, P, gain):
    """Correct the covariance P (N, N) by a slow measurement; write its gain to `gain` (N,).

    Return the variance of the measurement's innovation.
    """
    n, N, row = len(model.Q), len(P), model.slow
    if model.copies > 0:
        for i in range(N):
            gain[i] = P[i, N - 1]
        variance = model.r_slow + gain[N - 1]
    else:
        for i in range(N):
            total = 0.0
            for j in range(n):
                total += P[i, j] * row[j]
            gain[i] = total
        variance = model.r_slow
        for i in range(n):
            variance += row[i] * gain[i]
    correct_covariance(P, gain, variance)
    return variance


@njit
def is_copied(model, step):
    """Return whether a slow measurement will report the output of this step."""
    return model.copies > 0 and (step + model.delay) % model.interval == 0


@njit
def copy_covariance(model, P):
    """Make the present output the newest copy in the covariance P (N, N); drop the oldest copy."""
    n, N, row = len(model.Q), len(P), model.slow
    for i in range(N - 1, n + 1, -1):
        for j in range(N):
            P[i, j] = P[i - 1, j]
    for i in range(N - 1, n + 1, -1):
        for j in range(N):
            P[j, i] = P[j, i - 1]
    new = n + 1
    for j in range(N):
        if j == new:
            continue
        total = 0.0
        for i in range(n):
            total += row[i] * P[i, j]
        P[new, j] = total
        P[j, new] = total
    total = 0.0
    for i in range(n):
        total += row[i] * P[i, new]
    P[new, new] = total


@njit
def late_recursion(first, stop, model, P, outputs, tolerance, before, filled):
    """Compute gains and covariances step by step, until they repeat.

    They repeat if no element of the covariance differs from the one `interval` steps earlier by
    more than `tolerance`. Elements (i, j) are divided by the root of the product of the diagonal
    elements i and j.

    Parameters
    ----------
    first, stop
        The first step to compute, and the step before which to stop in any case; multiples of the
        interval between slow measurements.
    model
        The model, a `LateModel` with a state of N numbers.
    P
        Covariance of the state one step before `first`, shape (N, N); overwritten.
    outputs
        Rows (c, n) of the outputs whose covariances are wanted.
    tolerance
        Largest scaled difference that counts as none.
    before
        Covariance one interval before P, shape (N, N); overwritten. NaN if there is none.
    filled
        The arrays to fill, a `LateRows`.

    Returns
    -------
    int, bool
        The number of filled rows, and whether the last `interval` rows repeat.
    """
    n, N, interval = len(model.Q), len(P), model.interval
    work = np.empty(n)
    for k in range(first, stop):
        predict_covariance(model, P)
        apply_fast(model, P, filled.fast[k])
        if k % interval == 0:
            filled.S[k // interval] = apply_slow(model, P, filled.slow[k // interval])
        write_outputs(P, outputs, work, filled.outputs[k])
        if is_copied(model, k):
            copy_covariance(model, P)
        if (k + 1) % interval == 0:
            symmetrise(P)
            moved = 0.0
            for i in range(N):
                for j in range(N):
                    scale = np.sqrt(P[i, i] * P[j, j])
                    # so that NaN counts as a difference
                    if not abs(P[i, j] - before[i, j]) <= tolerance * scale:
                        moved = 1.0
                    before[i, j] = P[i, j]
            if moved == 0.0:
                return k + 1, True
    return stop, False
