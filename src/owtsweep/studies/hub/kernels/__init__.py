"""Compiled kernels: they run a scheme on many series at once, or on one series sample by sample.

All lanes of the batch engine share the gains, which do not depend on data. The innermost loop of
every step runs over the lanes, and LLVM makes vectors of it (`layout` says what that needs). A
record is processed in chunks, whose data stay in the processor's cache. Errors are summed during
the run.

| file | what of Ren et al. (2019) |
| --- | --- |
| `filtering` | multirate Kalman filter: Algorithm 6, and Algorithm 2 with the MHE |
| `smoothing` | online smoother: Algorithm 8 |
| `predicting` | predictor: Algorithm 9 |
| `horizon` | MHE: Eq. (11), Algorithms 4 and 5 |
| `sums` | squared errors: Eq. (12), NEES, NIS |
| `runs` | Algorithm 1: one after the other, chunk by chunk |
"""

#: Version of the kernels' numbers. Raise it whenever a change of the kernels alters a number that a
#: study stores, and list the change in CHANGELOG.md.
NUMERICS_VERSION = 4
