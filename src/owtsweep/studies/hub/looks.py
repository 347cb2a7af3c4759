"""The colours, markers and lines of the package's schemes and baselines."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle

#: EKF and MKF can coincide: a dashed line over a solid one shows both.
LOOKS = {
    "EKF": SchemeStyle("#CC79A7", "s", "-"),
    "MKF": SchemeStyle("#009E73", "D", (0, (4, 2))),
    "HME1": SchemeStyle("#0072B2", "o", "-"),
    "HME2": SchemeStyle("#E69F00", "^", (0, (6, 1, 1, 1))),
    "SKF": SchemeStyle("#4D4D4D", "p", "-"),
    "SKFA": SchemeStyle("#B3261E", "h", (0, (4, 2))),
    # the baselines: pale, and of one hue that no scheme has
    "NONE": SchemeStyle("#D3CCE3", "*", "-"),
    "HOLD": SchemeStyle("#B8AED0", "d", (0, (4, 2))),
    "DELTA": SchemeStyle("#9C8FBD", "8", (0, (1, 2))),
}
