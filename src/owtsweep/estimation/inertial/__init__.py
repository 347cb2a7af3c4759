"""Inertial navigation of a rigid body: one attitude, one strapdown model, and the filters on it.

`attitude` and `angles` hold rotations, in kernels and of whole records. `strapdown` moves a state
and its errors and corrects them; all filters are made of its kernels: `multiplicative`,
`invariant`, `unscented` and `complementary` are corrected by GNSS fixes, `reports` by late reports
of position and attitude. `smoother` stands behind `multiplicative`.
"""
