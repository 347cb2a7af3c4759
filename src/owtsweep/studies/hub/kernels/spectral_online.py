"""Runs the filter of one axis of SKF, with gains for the fixes that really arrived.

The state is that of `estimation.late_gains`.
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
def take_samples(step, samples, model, outputs, register, estimates):
    """Process samples along one axis, and fill the estimates.

    Parameters
    ----------
    step
        Number of the first sample's step.
    samples
        Specific force, m/s^2, and position fixes, m, shape (steps,) each; NaN for a missing fix.
    model, outputs
        The `LateModel` of the axis, with a state of N numbers, and the rows (2, n) of position and
        velocity.
    register
        State (N,), covariance (N, N), and an array (N,) for intermediate results; overwritten.
    estimates
        Position and velocity (steps, 2), covariance (steps, 2, 2), innovation (steps,) and its
        variance (steps,), to be filled.
    """
    force, fixes = samples
    x, P, gain = register
    states, covariances, innovations, variances = estimates
    A, fast = model.A, model.fast
    n, N = len(model.Q), len(x)
    for k in range(len(force)):
        residual = force[k] - x[n]
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
        innovations[k] = np.nan
        variances[k] = np.nan
        if not np.isnan(fixes[k]):
            variances[k] = apply_slow(model, P, gain)
            residual = fixes[k]
            if model.copies > 0:
                residual -= x[N - 1]
            else:
                for i in range(n):
                    residual -= model.slow[i] * x[i]
            innovations[k] = residual
            for i in range(N):
                x[i] += gain[i] * residual
        for a in range(2):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * x[i]
            states[k, a] = total
        write_outputs(P, outputs, gain, covariances[k])
        if is_copied(model, step + k):
            copy_covariance(model, P)
            for i in range(N - 1, n + 1, -1):
                x[i] = x[i - 1]
            x[n + 1] = states[k, 0]
        if (step + k) % model.interval == 0:
            symmetrise(P)
