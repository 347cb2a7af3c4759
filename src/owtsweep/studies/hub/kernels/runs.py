"""Whole records through a chain, chunk by chunk, with their errors summed on the fly.

One call works through many chunks without coming back to Python. Everything a chunk leaves between
its stages stays in the second cache.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.chain import chain_chunk, states_chunk
from owtsweep.studies.hub.kernels.layout import Output, Registers
from owtsweep.studies.hub.kernels.sums import direct_span, superposed_span
from owtsweep.studies.hub.kernels.vector import load, store


@njit
def group_of(registers, g):
    """The registers of one group of lanes."""
    return Registers(
        registers.x[g], registers.e[g], registers.X[g], registers.z[g], registers.ip[g],
        registers.iv[g], registers.arrival[g], registers.running[g], registers.node[g],
        registers.fix[g],
    )  # fmt: skip


@njit
def run_groups(k0, count, force, base, fixes, chain, registers, scratch, output):
    """One chunk of all groups: force (groups, rows, 8), fixes (groups, fixes, 8)."""
    for g in range(force.shape[0]):
        out = Output(output.position[g], output.velocity[g], output.innovation[g])
        chain_chunk(
            k0, count, force[g], base, fixes[g], chain, group_of(registers, g), scratch, out
        )


@njit
def superposed(k0, stop, chunk, settled, force, base, fixes, position, velocity, direction, chain,
               weights, registers, scratch, output, sums):  # fmt: skip
    """Steps k0 ... stop - 1 of eight replicates in the groups motion, noise x, noise y."""
    while k0 < stop:
        count = min(chunk, stop - k0)
        run_groups(k0, count, force, base, fixes, chain, registers, scratch, output)
        early = min(max(settled - k0, 0), count)
        if early > 0:
            superposed_span(k0, 0, early, 0, position, velocity, base, output, direction, chain,
                            weights, sums)  # fmt: skip
        if early < count:
            superposed_span(k0, early, count, 18, position, velocity, base, output, direction,
                            chain, weights, sums)  # fmt: skip
        k0 += count


@njit
def direct(k0, stop, chunk, settled, force, base, fixes, position, velocity, direction, chain,
           weights, registers, scratch, output, sums, squared):  # fmt: skip
    """Steps k0 ... stop - 1 of eight replicates in the groups x and y of whole series."""
    while k0 < stop:
        count = min(chunk, stop - k0)
        run_groups(k0, count, force, base, fixes, chain, registers, scratch, output)
        early = min(max(settled - k0, 0), count)
        if early > 0:
            direct_span(k0, 0, early, 0, position, velocity, base, output, direction, chain,
                        weights, sums, squared)  # fmt: skip
        if early < count:
            direct_span(k0, early, count, 18, position, velocity, base, output, direction,
                        chain, weights, sums, squared)  # fmt: skip
        k0 += count


@njit
def states(k0, count, force, base, fixes, chain, registers, scratch, output, found):
    """Filtered or smoothed states of one chunk of all groups, found (groups, 4 rows, 8)."""
    for g in range(force.shape[0]):
        out = Output(output.position[g], output.velocity[g], output.innovation[g])
        states_chunk(
            k0, count, force[g], base, fixes[g], chain, group_of(registers, g), scratch, out
        )
        for row in range(4 * count):
            store(found[g], row, load(scratch.X, row))
