"""Runs SKF sample by sample, with gains for the fixes that really arrived.

Each axis has a filter of its own; the state is that of `estimation.late_model`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.late import (
    apply_fast,
    apply_slow,
    copy_covariance,
    is_copied,
    predict_covariance,
    symmetrise,
    write_outputs,
)


@njit
def take_samples(step, axis, samples, model, outputs, register, estimates):
    """Process samples of one axis and fill that axis' part of the estimates.

    Parameters
    ----------
    step
        Number of the first sample's step.
    axis
        0 for x, 1 for y.
    samples
        Specific force (steps, 2), m/s^2, and position fixes (steps, 2), m, in NED; NaN for a
        missing fix.
    model, outputs
        The `LateModel` of the axis, with a state of N numbers, and the rows (2, n) of position and
        velocity.
    register
        State (N,), covariance (N, N), and an array (N,) for intermediate results; overwritten.
    estimates
        State (steps, 4), covariance (steps, 2, 2), innovation (steps, 2) and its variance
        (steps, 2), to be filled.
    """
    force, fixes = samples
    x, P, gain = register
    states, covariances, innovations, variances = estimates
    A, fast = model.A, model.fast
    n, N = len(model.Q), len(x)
    for k in range(len(force)):
        residual = force[k, axis] - x[n]
        for i in range(0, n, 2):
            block = A[i // 2]
            first = block[0, 0] * x[i] + block[0, 1] * x[i + 1]
            second = block[1, 0] * x[i] + block[1, 1] * x[i + 1]
            x[i], x[i + 1] = first, second
            residual -= fast[i] * first + fast[i + 1] * second
        predict_covariance(model, P)
        apply_fast(model, P, gain)
        for i in range(N):
            x[i] += gain[i] * residual
        innovations[k, axis] = np.nan
        variances[k, axis] = np.nan
        if not np.isnan(fixes[k, axis]):
            variances[k, axis] = apply_slow(model, P, gain)
            residual = fixes[k, axis]
            if model.copies > 0:
                residual -= x[N - 1]
            else:
                for i in range(n):
                    residual -= model.slow[i] * x[i]
            innovations[k, axis] = residual
            for i in range(N):
                x[i] += gain[i] * residual
        for a in range(2):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * x[i]
            states[k, 2 * a + axis] = total
        write_outputs(P, outputs, gain, covariances[k])
        if is_copied(model, step + k):
            copy_covariance(model, P)
            for i in range(N - 1, n + 1, -1):
                x[i] = x[i - 1]
            x[n + 1] = states[k, axis]
        if (step + k) % model.interval == 0:
            symmetrise(P)
