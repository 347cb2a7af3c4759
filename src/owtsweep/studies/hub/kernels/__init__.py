"""Compiled kernels of the batch engine: many series of one scheme at once.

A lane is one scalar series of one axis; all lanes share the gains, which depend on no data. Arrays
are (steps, lanes), so the innermost loops run over neighbouring memory. Records are worked through
in chunks that stay in the cache, and errors are summed on the fly.
"""

#: Raised whenever a change of the kernels alters a number that a study stores; CHANGELOG.md says
#: what each of them was.
NUMERICS_VERSION = 3
