"""The colours, markers and lines of the schemes of Ren et al. (2019) in all figures."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle

#: EKF and MKF can coincide: a dashed line over a solid one shows both.
LOOKS = {
    "EKF": SchemeStyle("#CC79A7", "s", "-"),
    "MKF": SchemeStyle("#009E73", "D", (0, (4, 2))),
    "HME1": SchemeStyle("#0072B2", "o", "-"),
    "HME2": SchemeStyle("#E69F00", "^", (0, (6, 1, 1, 1))),
}
