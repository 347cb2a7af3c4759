"""Compiled kernels: they run a scheme on many series at once, or on one series sample by sample.

The batch engine runs many series at once. A lane is one series of numbers along one axis, and eight
lanes make a group. All lanes share the gains, which do not depend on data. Arrays have one row per
step and one column per lane, so the innermost loops run over neighbouring memory. A record is
processed in chunks of steps; a chunk's data stay in the processor's cache. Errors are summed during
the run.
"""

#: Version of the kernels' numbers. Raise it whenever a change of the kernels alters a number that a
#: study stores, and list the change in CHANGELOG.md.
NUMERICS_VERSION = 3
