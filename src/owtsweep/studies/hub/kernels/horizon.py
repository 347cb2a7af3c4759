"""The moving horizon estimator in front of the filter: its registers and maps."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.layout import ALL, AVERAGED
from owtsweep.vectors.lanes import element, load, store, zero


@njit
def added(n0, n1, n2, maps, at, columns, datum):
    """A node's state plus the contribution of one datum; the three sums run side by side."""
    return (
        n0 + element(maps, at) * datum,
        n1 + element(maps, at + columns) * datum,
        n2 + element(maps, at + 2 * columns) * datum,
    )


@njit
def horizon_fix(q, fixes, mhe, registers):
    """Take fix number q: store the finished interval, solve the window, start a new interval."""
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
    G = 3 * columns * min(q, maps.shape[0] - 1)  # start of this fix's map
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
    """The row of the position that is valid at step i of a chunk; the chunk's first tick is row 0.

    A tick is a multiple of T_m.
    """
    return (k0 + i) // interval - k0 // interval


@njit
def positions_from(k0, i, interval, rows):
    """The MHE's positions in `rows`, as `filter_steps` takes them from step i of a chunk on."""
    return (rows, tick_of(k0, i, interval), (k0 + i) % interval, interval)


@njit
def horizon_steps(steps, fed, q, chain, memory):
    """Compute the MHE's positions at some steps of a chunk between fix number q and the next.

    At each multiple of T_m the position is predicted from the last node by (11d). It is valid until
    the next one, and is stored in the row that `tick_of` gives. Before the first solution it is the
    last fix. The specific force is integrated in the form in which the MHE takes it (`inputs`).
    """
    k0, first, stop, _ = steps
    mhe, fix_interval = chain.mhe, chain.filter.fix_interval
    force, source = fed.force, k0 - chain.filter.input_delay - fed.base
    fixes, registers, positions = fed.fixes, memory.registers, memory.scratch.positions
    T = mhe.step
    half = 0.5 * T * T
    running, node = registers.running, registers.node
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
                tf = since_fix * T
                held = n0 + tf * n1 + 0.5 * tf * tf * n2 + p
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
        p = p + (T * v + half * u)
        v = v + T * u
        since_fix += 1
        phase += 1
        if phase == interval:
            phase = 0
    store(running, 0, p)
    store(running, 1, v)
    store(running, 2, gathered)
    store(running, 3, mean)
    store(registers.fix, 0, held)
