"""The covariance recursion of a two-rate Kalman filter, compiled.

One measurement row is fast (every step), one slow (every `interval` steps). Symbols as in
Algorithm 6 of Ren et al. (2019): P covariance, K gain, H measurement rows, S = H P H' + R.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit

#: How the gain and the covariance treat a step without a slow measurement.
PROPER, MASK_COLUMNS, MASK_ROWS, EVERY_STEP = 0, 1, 2, 3


@njit
def recursion(A, Q, slow, fast, r_slow, r_fast, P0, applied, start_interval, start_steps, interval,
              rule, tolerance, K, S, Pm, Pf):  # fmt: skip
    """Fill the rows of K, S, Pm, Pf until a whole cycle repeats; returns how many rows are filled.

    `applied` (rows,) receives where the slow measurement corrects the state. With `fast` all zero
    there is no fast measurement (the model takes it as an input). A cycle repeats when no element
    of Pf, scaled by its diagonal, has moved by more than `tolerance` over `interval` steps.
    """
    rows, n = K.shape[0], A.shape[0]
    has_fast = np.any(fast != 0.0)
    P = P0.copy()
    AP = np.empty((n, n))
    L = np.empty((n, n))
    LP = np.empty((n, n))
    moved = np.inf
    quiet = 0
    for k in range(rows):
        for i in range(n):
            for j in range(n):
                total = 0.0
                for m in range(n):
                    total += A[i, m] * P[m, j]
                AP[i, j] = total
        for i in range(n):
            for j in range(n):
                total = Q[i, j]
                for m in range(n):
                    total += AP[i, m] * A[j, m]
                Pm[k, i, j] = total
        for i in range(n):
            for j in range(i):
                mean = 0.5 * (Pm[k, i, j] + Pm[k, j, i])
                Pm[k, i, j] = mean
                Pm[k, j, i] = mean

        if k < start_steps:
            is_slow = k % start_interval == 0
        else:
            is_slow = k % interval == 0
        applied[k] = is_slow or rule == MASK_ROWS
        use_slow = is_slow or rule != PROPER

        ss, ff, sf = r_slow, r_fast, 0.0
        for i in range(n):
            hs, hf = 0.0, 0.0
            for j in range(n):
                hs += Pm[k, i, j] * slow[j]
                hf += Pm[k, i, j] * fast[j]
            K[k, i, 0], K[k, i, 1] = hs, hf  # P H' for now
        for i in range(n):
            ss += slow[i] * K[k, i, 0]
            ff += fast[i] * K[k, i, 1]
            sf += slow[i] * K[k, i, 1]
        S[k] = ss
        for i in range(n):
            hs, hf = K[k, i, 0], K[k, i, 1]
            if use_slow and has_fast:
                determinant = ss * ff - sf * sf
                K[k, i, 0] = (hs * ff - hf * sf) / determinant
                K[k, i, 1] = (hf * ss - hs * sf) / determinant
            elif use_slow:
                K[k, i, 0], K[k, i, 1] = hs / ss, 0.0
            elif has_fast:
                K[k, i, 0], K[k, i, 1] = 0.0, hf / ff
            else:
                K[k, i, 0], K[k, i, 1] = 0.0, 0.0
        if not is_slow:
            if rule == MASK_COLUMNS:
                K[k, :, 0] = 0.0
            elif rule == MASK_ROWS:
                K[k, 0, :] = 0.0

        for i in range(n):
            for j in range(n):
                L[i, j] = -K[k, i, 0] * slow[j] - K[k, i, 1] * fast[j]
            L[i, i] += 1.0
        for i in range(n):
            for j in range(n):
                total = 0.0
                for m in range(n):
                    total += L[i, m] * Pm[k, m, j]
                LP[i, j] = total
        joseph = rule in (PROPER, EVERY_STEP) or is_slow
        for i in range(n):
            for j in range(n):
                if joseph:
                    total = r_slow * K[k, i, 0] * K[k, j, 0] + r_fast * K[k, i, 1] * K[k, j, 1]
                    for m in range(n):
                        total += LP[i, m] * L[j, m]
                    Pf[k, i, j] = total
                else:
                    Pf[k, i, j] = LP[i, j]
        for i in range(n):
            for j in range(i):
                mean = 0.5 * (Pf[k, i, j] + Pf[k, j, i])
                Pf[k, i, j] = mean
                Pf[k, j, i] = mean
        P[:, :] = Pf[k]

        if k >= start_steps + interval:
            moved = 0.0
            for i in range(n):
                for j in range(n):
                    scale = np.sqrt(abs(Pf[k, i, i] * Pf[k, j, j]))
                    if scale > 0.0:
                        moved = max(moved, abs(Pf[k, i, j] - Pf[k - interval, i, j]) / scale)
            quiet = quiet + 1 if moved <= tolerance else 0
            if quiet >= interval and (k + 1) % interval == 0:
                return k + 1
    return rows
