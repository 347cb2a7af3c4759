"""Fixed-lag smoothing in O(1) per step, and open-loop prediction, over a chunk."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import schedule_row


@njit
def smooth_chunk(k0, count, arrays, memory):
    """Replace X of the steps k0 - window ... by their smoothed states (Algorithm 8).

    With e_k = x_{k|k} - x_{k|k-1} and the RTS gains C, the smoothed state is x_{k|k} + S_k, where
    S_k = C_k (e_{k+1} + S_{k+1} - W_{k+1} e_{k+1+window}). The recursion is stable backwards in
    time only, so each chunk starts it anew at its end with the window as run-up.
    """
    window = arrays.window
    rows = arrays.C.shape[0]
    lanes = memory.x.shape[1]
    e, X, S = memory.e, memory.X, memory.S
    last = window + count - 1
    S[:] = 0.0
    for j in range(last - 1, -1, -1):
        k = k0 - window + j
        if k < 0:
            break
        C = arrays.C[schedule_row(k, rows, arrays.cycle)]
        c00, c01, c02, c03 = C[0, 0], C[0, 1], C[0, 2], C[0, 3]
        c10, c11, c12, c13 = C[1, 0], C[1, 1], C[1, 2], C[1, 3]
        c20, c21, c22, c23 = C[2, 0], C[2, 1], C[2, 2], C[2, 3]
        c30, c31, c32, c33 = C[3, 0], C[3, 1], C[3, 2], C[3, 3]
        following = e[j + 1]
        s = S[0]
        if j + 1 + window <= last:
            W = arrays.W[schedule_row(k + 1, rows, arrays.cycle)]
            leaving = e[j + 1 + window]
            for i in range(4):
                w0, w1, w2, w3 = W[i, 0], W[i, 1], W[i, 2], W[i, 3]
                for lane in range(lanes):
                    s[i, lane] -= (
                        w0 * leaving[0, lane]
                        + w1 * leaving[1, lane]
                        + w2 * leaving[2, lane]
                        + w3 * leaving[3, lane]
                    )
        smoothed = j < count
        x = X[j]
        for lane in range(lanes):
            y0 = following[0, lane] + s[0, lane]
            y1 = following[1, lane] + s[1, lane]
            y2 = following[2, lane] + s[2, lane]
            y3 = following[3, lane] + s[3, lane]
            s0 = c00 * y0 + c01 * y1 + c02 * y2 + c03 * y3
            s1 = c10 * y0 + c11 * y1 + c12 * y2 + c13 * y3
            s2 = c20 * y0 + c21 * y1 + c22 * y2 + c23 * y3
            s3 = c30 * y0 + c31 * y1 + c32 * y2 + c33 * y3
            s[0, lane], s[1, lane], s[2, lane], s[3, lane] = s0, s1, s2, s3
            if smoothed:
                x[0, lane] += s0
                x[1, lane] += s1
                x[2, lane] += s2
                x[3, lane] += s3


@njit
def shift(count, arrays, memory):
    """Keep the newest `window` filtered states and corrections for the next chunk."""
    window = arrays.window
    for j in range(window):
        for i in range(4):
            for lane in range(memory.x.shape[1]):
                memory.e[j, i, lane] = memory.e[count + j, i, lane]
                memory.X[j, i, lane] = memory.X[count + j, i, lane]


@njit
def predict_chunk(k0, count, force, zeros, predictor, memory):
    """Algorithm 9 for all steps of the chunk by differences of running sums of the inputs.

    The sums start anew in every chunk, so they never grow large against what they differ by.
    """
    n, T, half = predictor.steps, predictor.step, predictor.half
    V, P = memory.V, memory.P
    lanes = force.shape[1]
    V[0] = 0.0
    P[0] = 0.0
    for i in range(count + n - 1):
        j = k0 - n + i
        u = force[j] if j >= 0 else zeros
        for lane in range(lanes):
            P[i + 1, lane] = P[i, lane] + T * V[i, lane] + half * u[lane]
            V[i + 1, lane] = V[i, lane] + T * u[lane]
    for i in range(count):
        x = memory.X[i]
        for lane in range(lanes):
            p, v, b = x[0, lane], x[1, lane], x[3, lane]
            dv = V[i + n, lane] - V[i, lane]
            dp = P[i + n, lane] - P[i, lane] - n * T * V[i, lane]
            memory.position[i, lane] = p + predictor.pv * v + predictor.pb * b + dp
            memory.velocity[i, lane] = v + predictor.vb * b + dv
