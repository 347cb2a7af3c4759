"""Runs the moving horizon estimator (MHE), which gives the filter its positions."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.layout import ALL, AVERAGED
from owtsweep.vectors.lanes import element, load, store, zero


@njit
def added(n0, n1, n2, maps, at, columns, datum):
    """Return n0, n1, n2 plus the contribution of one datum to the state n0, n1, n2.

    The state is one of the moving horizon estimator: position, velocity, bias. The contribution is
    the datum times a column, three elements, of a matrix in `maps`. A row of the matrix has
    `columns` elements; `at` is the flat index in `maps` of the column's first element.
    """
    return (
        n0 + element(maps, at) * datum,
        n1 + element(maps, at + columns) * datum,
        n2 + element(maps, at + 2 * columns) * datum,
    )


@njit
def horizon_fix(q, fixes, mhe, registers):
    """Take position fix number q into the MHE's window; compute the state at the fix.

    The window of the MHE (moving horizon estimator) holds the newest fixes and, between fixes, what
    the inputs (specific force) added to position and velocity. The sums over the inputs since the
    last fix are stored in the window and set to zero. The state (position, velocity, bias) goes to
    registers.node. Before fix number mhe.first no state is computed. `fixes` are `Fed.fixes`, `mhe`
    is `HorizonArrays`.
    """
    nm = mhe.horizon
    z, ip, iv, running = registers.z, registers.ip, registers.iv, registers.running
    if q > 0:
        store(ip, (q - 1) % nm, load(running, 0))
        store(iv, (q - 1) % nm, load(running, 1))
    store(running, 0, zero(running))
    store(running, 1, zero(running))
    store(z, q % (nm + 1), load(fixes, q))
    if q < mhe.first:
        return
    n = min(q, nm)
    maps, columns = mhe.maps, mhe.maps.shape[2]
    G = 3 * columns * min(q, maps.shape[0] - 1)  # start of this fix's matrix
    n0, n1, n2 = zero(running), zero(running), zero(running)
    at = (q - n) % (nm + 1)
    for j in range(n + 1):
        n0, n1, n2 = added(n0, n1, n2, maps, G + j, columns, load(z, at))
        at = at + 1 if at < nm else 0
    at = (q - n) % nm
    for j in range(n + 1, 4 * n + 1, 3):
        n0, n1, n2 = added(n0, n1, n2, maps, G + j, columns, load(ip, at))
        n0, n1, n2 = added(n0, n1, n2, maps, G + j + 1, columns, load(iv, at))
        at = at + 1 if at + 1 < nm else 0
    if mhe.arrival and q >= nm:
        at = 3 * ((q - nm) % (nm + 1))
        for m in range(3):
            datum = load(registers.arrival, at + m)
            n0, n1, n2 = added(n0, n1, n2, maps, G + 4 * n + 1 + m, columns, datum)
    store(registers.node, 0, n0)
    store(registers.node, 1, n1)
    store(registers.node, 2, n2)


@njit
def tick_of(k0, i, interval):
    """Return the row in which the MHE's position that is valid at step i of a chunk is stored.

    The MHE (moving horizon estimator) gives a position at each multiple of `interval` steps. The
    chunk, steps that are computed together, begins at step k0 of the record. Row 0 holds the
    position that is valid at the chunk's first step.
    """
    return (k0 + i) // interval - k0 // interval


@njit
def positions_from(k0, i, interval, rows):
    """Return the MHE's positions, from step i of a chunk on, in the form that `filter_steps` takes.

    The MHE is the moving horizon estimator. The form is (rows, row, phase, interval). `rows` is the
    array of the chunk's positions, one for every `interval` steps. The position that is valid at
    step i is in row `row` and came `phase` steps before step i. The chunk, steps that are computed
    together, begins at step k0 of the record.
    """
    return (rows, tick_of(k0, i, interval), (k0 + i) % interval, interval)


@njit
def horizon_steps(steps, fed, q, chain, memory):
    """Compute the MHE's positions at some steps of a chunk, between fix number q and the next fix.

    The MHE is the moving horizon estimator. At each multiple of mhe.interval (T_m) a position is
    predicted by Eq. (11d) of Ren et al. (2019) from the state at fix number q. The position is
    valid until the next multiple, and is stored in the row of memory.scratch.positions that
    `tick_of` returns. Before fix number mhe.first the position is the fix itself. The specific
    force is integrated as the MHE takes it: all samples, averaged or sampled (mhe.inputs). `steps`,
    `fed`, `chain` and `memory` are structures of `kernels.layout`.
    """
    k0, first, stop, _ = steps
    mhe, fix_interval = chain.mhe, chain.filter.fix_interval
    force, source = fed.force, k0 - chain.filter.input_delay - fed.base
    fixes, registers, positions = fed.fixes, memory.registers, memory.scratch.positions
    T = mhe.step
    half = 0.5 * T * T
    running, node, growth, lean = registers.running, registers.node, mhe.growth, mhe.lean
    interval, inputs, solved = mhe.interval, mhe.inputs, q >= mhe.first
    n0, n1, n2 = load(node, 0), load(node, 1), load(node, 2)
    p, v, gathered, mean = load(running, 0), load(running, 1), load(running, 2), load(running, 3)
    held = load(registers.fix, 0)
    k = k0 + first
    phase, tick = k % interval, tick_of(k0, first, interval)
    since_fix = k - q * fix_interval
    if phase > 0:
        store(positions, tick, held)
        tick += 1
    for i in range(first, stop):
        if phase == 0:
            if solved:
                g = growth[since_fix, 0]
                held = n0 + g[1] * n1 + g[2] * n2 + p + g[0] * n0
            elif since_fix == 0:
                held = load(fixes, q)
            store(positions, tick, held)
            tick += 1
        u = load(force, source + i)
        if inputs != ALL:
            gathered = gathered + u
            if phase == 0:
                if inputs == AVERAGED:
                    mean = gathered / float(interval)
                else:
                    mean = u
                gathered = zero(running)
            u = mean
        leaning = lean.vp * p + lean.vv * v + lean.vu * u
        p = p + (T * v + half * u) + (lean.pp * p + lean.pv * v + lean.pu * u)
        v = v + T * u + leaning
        since_fix += 1
        phase += 1
        if phase == interval:
            phase = 0
    store(running, 0, p)
    store(running, 1, v)
    store(running, 2, gathered)
    store(running, 3, mean)
    store(registers.fix, 0, held)
