"""Compiled kernels: a scheme run on many series at once, or on one series sample by sample.

In the batch engine a lane is one scalar series of one axis. All lanes share the gains, which do not
depend on data. Arrays are (steps, lanes), so the innermost loops run over neighbouring memory.
Records are processed in chunks that stay in the cache, and errors are summed during the run.
"""

#: Raised whenever a change of the kernels alters a number that a study stores; CHANGELOG.md lists
#: these changes.
NUMERICS_VERSION = 3
