"""Compiled kernels: they run a scheme on many series at once, or on one series sample by sample.

In the batch engine a lane is one series of numbers along one axis, and eight lanes make a group.
All lanes share the gains, which do not depend on data. Arrays have the shape (steps, lanes), so the
innermost loops run over neighbouring memory. Records are processed in chunks of steps that stay in
the cache, and errors are summed during the run.
"""

#: Version of the kernels' numbers. Raise it whenever a change of the kernels alters a number that a
#: study stores, and list the change in CHANGELOG.md.
NUMERICS_VERSION = 3
