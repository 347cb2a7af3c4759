"""Runs the filter of one axis of SKF on one series, with gains that are computed before.

The state is that of `estimation.late_gains`. `kernels.spectral` runs eight series with one model;
this kernel serves series that each have a model of their own.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row


@njit
def follow(first, samples, model, outputs, gains, x, estimates):
    """Run the filter until a fix that is due has not arrived; return the number of steps run.

    Parameters
    ----------
    first
        Number of the first step, counted from the filter's start.
    samples
        Specific force, m/s^2, and position fixes, m, (steps,) each; NaN for a missing fix.
    model, outputs
        The `LateModel`, with a state of N numbers, and the rows (2, n) of position and velocity.
    gains
        Gains of an IMU sample (rows, N) and of a fix (rows / interval, N), innovation variances of
        fixes (rows / interval,), and covariances of the outputs (rows, 2, 2). After the last row,
        the rows of the last interval repeat.
    x
        The state (N,); overwritten.
    estimates
        Outputs (steps, 2), covariance (steps, 2, 2), innovation (steps,) and its variance (steps,),
        to be filled.
    """
    force, fixes = samples
    fast_gains, slow_gains, S, covariances = gains
    states, covariance, innovations, variances = estimates
    A, fast, interval = model.A, model.fast, model.interval
    # as `estimation.late.is_copied`, without handing over the model at each step: half the time
    copies, delay = model.copies, model.delay
    n, N, rows = len(model.Q), len(x), len(fast_gains)
    for k in range(len(force)):
        step = first + k
        if step % interval == 0 and np.isnan(fixes[k]):
            return k
        residual = force[k] - x[n]
        for i in range(0, n, 2):
            block = A[i // 2]
            one = block[0, 0] * x[i] + block[0, 1] * x[i + 1]
            two = block[1, 0] * x[i] + block[1, 1] * x[i + 1]
            x[i], x[i + 1] = one, two
            residual -= fast[i] * one + fast[i + 1] * two
        row = schedule_row(step, rows, interval)
        gain = fast_gains[row]
        for i in range(N):
            x[i] += gain[i] * residual
        innovations[k] = np.nan
        variances[k] = np.nan
        if step % interval == 0:
            number = min(step // interval, len(S) - 1)
            innovation = fixes[k]
            if copies > 0:
                innovation -= x[N - 1]
            else:
                for i in range(n):
                    innovation -= model.slow[i] * x[i]
            gain = slow_gains[number]
            for i in range(N):
                x[i] += gain[i] * innovation
            innovations[k] = innovation
            variances[k] = S[number]
        for a in range(2):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * x[i]
            states[k, a] = total
            for b in range(2):
                covariance[k, a, b] = covariances[row, a, b]
        if copies > 0 and (step + delay) % interval == 0:
            for i in range(N - 1, n + 1, -1):
                x[i] = x[i - 1]
            x[n + 1] = states[k, 0]
    return len(force)
