"""The colours, markers and lines of the floater study's schemes."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle

#: Red and orange: the paper's predictors. Blue to green: consistent filters, by what they know.
#: Violet: other observers. Grey and brown: no model of the motion.
LOOKS = {
    "KF_STEADY": SchemeStyle("#E69F00", "^", (0, (4, 2))),
    "KF": SchemeStyle("#D55E00", "o", "-"),
    "KF_CONSISTENT": SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
    "KF_BIAS": SchemeStyle("#0072B2", "s", (0, (4, 2))),
    "KF_DELAY": SchemeStyle("#44AA99", "<", (0, (1, 1))),
    "KF_REPAIRED": SchemeStyle("#117733", "P", "-"),
    "ERROR_STATE": SchemeStyle("#332288", "D", (0, (8, 3))),
    "PASSIVE_OBSERVER": SchemeStyle("#CC79A7", "X", "-"),
    "COMPLEMENTARY": SchemeStyle("#882255", "p", (0, (2, 2))),
    "LOWPASS": SchemeStyle("#8C8C8C", "*", (0, (1, 2))),
    "FIXED_LAG": SchemeStyle("#999933", "d", (0, (3, 1, 1, 1, 1, 1))),
}
