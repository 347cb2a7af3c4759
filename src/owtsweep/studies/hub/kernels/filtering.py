"""The multirate Kalman filter over a chunk, with or without the MHE in front of it."""

from __future__ import annotations

from owtsweep.compiled import njit

ALL, AVERAGED, SAMPLED = 0, 1, 2


@njit
def schedule_row(k, rows, cycle):
    """The stored row of the gain schedule that serves step k."""
    if k < rows:
        return k
    settled = rows - cycle
    return settled + (k - settled) % cycle


@njit
def horizon_fix(q, fixes, mhe, memory):
    """A fix arrives: push the finished interval, solve the window, start a new interval."""
    lanes = fixes.shape[1]
    nm = mhe.horizon
    z, ip, iv, running, node = memory.z, memory.ip, memory.iv, memory.running, memory.node
    for lane in range(lanes):
        if q > 0:
            ip[(q - 1) % nm, lane] = running[0, lane]
            iv[(q - 1) % nm, lane] = running[1, lane]
        running[0, lane] = 0.0
        running[1, lane] = 0.0
        z[q % (nm + 1), lane] = fixes[q, lane]
    if q < mhe.first:
        return
    n = min(q, nm)
    G = mhe.maps[min(q, mhe.maps.shape[0] - 1)]
    for i in range(3):
        for lane in range(lanes):
            node[i, lane] = 0.0
        for j in range(n + 1):
            g = G[i, j]
            at = (q - n + j) % (nm + 1)
            for lane in range(lanes):
                node[i, lane] += g * z[at, lane]
        for j in range(n):
            gp, gv = G[i, n + 1 + 3 * j], G[i, n + 2 + 3 * j]
            at = (q - n + j) % nm
            for lane in range(lanes):
                node[i, lane] += gp * ip[at, lane] + gv * iv[at, lane]
        if mhe.arrival and q >= nm:
            at = (q - nm) % (nm + 1)
            for m in range(3):
                g = G[i, n + 1 + 3 * n + m]
                for lane in range(lanes):
                    node[i, lane] += g * memory.arrival[at, m, lane]


@njit
def horizon_position(k, q, fixes, mhe, fix_interval, memory):
    """The MHE's position at step k, (11d) with nothing to contradict its last link."""
    tf = (k - q * fix_interval) * mhe.step
    for lane in range(fixes.shape[1]):
        if q >= mhe.first:
            memory.fix[lane] = (
                memory.node[0, lane]
                + tf * memory.node[1, lane]
                + 0.5 * tf * tf * memory.node[2, lane]
                + memory.running[0, lane]
            )
        else:
            memory.fix[lane] = fixes[q, lane]


@njit
def horizon_input(k, sample, mhe, memory):
    """Integrate the input of step k, as it reaches the MHE, over one IMU step."""
    T = mhe.step
    half = 0.5 * T * T
    running = memory.running
    tick = k % mhe.interval == 0
    for lane in range(running.shape[1]):
        if mhe.inputs == ALL:
            u = sample[lane]
        else:
            running[2, lane] += sample[lane]
            if tick:
                if mhe.inputs == AVERAGED:
                    running[3, lane] = running[2, lane] / mhe.interval
                else:
                    running[3, lane] = sample[lane]
                running[2, lane] = 0.0
            u = running[3, lane]
        running[0, lane] += T * running[1, lane] + half * u
        running[1, lane] += T * u


@njit
def filter_chunk(k0, count, force, fixes, zeros, arrays, mhe, memory):
    """Algorithm 6 over steps k0 ... k0 + count - 1 of all lanes.

    Writes filtered states and corrections behind the window that the last chunk left.
    """
    lanes = force.shape[1]
    A, B, h = arrays.A, arrays.B, arrays.h
    a01, a02, a03, a12, a13, a22 = A[0, 1], A[0, 2], A[0, 3], A[1, 2], A[1, 3], A[2, 2]
    b0, b1 = B[0], B[1]
    h2, h3 = h[2], h[3]
    M, delay, window = arrays.fix_interval, arrays.input_delay, arrays.window
    rows = arrays.K.shape[0]
    x = memory.x
    for i in range(count):
        k = k0 + i
        row = schedule_row(k, rows, arrays.cycle)
        j = k - delay
        now = force[j] if j >= 0 else zeros
        before = force[j - 1] if j >= 1 else zeros
        q = k // M
        applied = arrays.applied[row]
        if mhe.active:
            if k % M == 0:
                horizon_fix(q, fixes, mhe, memory)
            if k % (mhe.interval if q >= mhe.first else M) == 0:
                horizon_position(k, q, fixes, mhe, M, memory)
        elif applied:
            for lane in range(lanes):
                memory.fix[lane] = fixes[q, lane]
        K = arrays.K[row]
        k00, k10, k20, k30 = K[0, 0], K[1, 0], K[2, 0], K[3, 0]
        k01, k11, k21, k31 = K[0, 1], K[1, 1], K[2, 1], K[3, 1]
        e = memory.e[window + i]
        X = memory.X[window + i]
        innovation = memory.innovation[i]
        fix = memory.fix
        for lane in range(lanes):
            u = before[lane]
            x1, x2, x3 = x[1, lane], x[2, lane], x[3, lane]
            m0 = x[0, lane] + a01 * x1 + a02 * x2 + a03 * x3 + b0 * u
            m1 = x1 + a12 * x2 + a13 * x3 + b1 * u
            m2 = a22 * x2
            r = now[lane] - h2 * m2 - h3 * x3
            e0, e1, e2, e3 = k01 * r, k11 * r, k21 * r, k31 * r
            if applied:
                s = fix[lane] - m0
                innovation[lane] = s
                e0 += k00 * s
                e1 += k10 * s
                e2 += k20 * s
                e3 += k30 * s
            e[0, lane], e[1, lane], e[2, lane], e[3, lane] = e0, e1, e2, e3
            m0 += e0
            m1 += e1
            m2 += e2
            m3 = x3 + e3
            x[0, lane], x[1, lane], x[2, lane], x[3, lane] = m0, m1, m2, m3
            X[0, lane], X[1, lane], X[2, lane], X[3, lane] = m0, m1, m2, m3
        if mhe.active:
            if mhe.arrival and k % M == 0:
                at = q % (mhe.horizon + 1)
                for lane in range(lanes):
                    memory.arrival[at, 0, lane] = x[0, lane]
                    memory.arrival[at, 1, lane] = x[1, lane]
                    memory.arrival[at, 2, lane] = x[3, lane]
            horizon_input(k, now, mhe, memory)
