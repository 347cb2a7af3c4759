"""Compiled kernels: they run a scheme on many series at once, or on one series sample by sample.

All lanes of the batch engine share the gains, which do not depend on data. The innermost loop of
every step runs over the lanes, and LLVM makes vectors of it (`layout` says what that needs). A
record is processed in chunks, whose data stay in the processor's cache. Errors are summed during
the run.

| file | what of Ren et al. (2019) |
| --- | --- |
| `chain` | Algorithm 1, chunk by chunk: filter (6, with the MHE 2), smoother (8), predictor (9) |
| `horizon` | MHE: Eq. (11), Algorithms 4 and 5 |
| `sums` | squared errors: Eq. (12), NEES, NIS |
| `feeding` | what sensors report, Eqs. (3) to (5), into lanes |
| `online` | Algorithms 6, 8 and 9 sample by sample, with gains for the fixes that came |
| `window` | MHE as `online` runs it: Eq. (11) |
| `layout`, `online_layout` | the arrays that the kernels take |
"""

#: Version of the kernels' numbers. Raise it whenever a change of the kernels alters a number that a
#: study stores, and list the change in CHANGELOG.md.
NUMERICS_VERSION = 9
