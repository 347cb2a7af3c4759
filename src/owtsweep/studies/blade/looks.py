"""The colours, markers and lines of the blade study's schemes."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle

#: Grey and brown: no inertial unit. Blue: the filters that should agree. Green: what one of them
#: knows besides. Violet and red: who waits.
LOOKS = {
    "HOLD": SchemeStyle("#B8AED0", "d", (0, (4, 2))),  # as in the hub study
    "GNSS_WAHBA": SchemeStyle("#999933", "*", (0, (3, 1, 1, 1, 1, 1))),
    "COMPLEMENTARY": SchemeStyle("#882255", "p", (0, (2, 2))),
    "UKF": SchemeStyle("#D55E00", "o", "-"),
    "MEKF": SchemeStyle("#0072B2", "s", (0, (4, 2))),
    "INVARIANT_EKF": SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
    "MEKF_HEADING": SchemeStyle("#117733", "P", "-"),
    "MEKF_OFFSET": SchemeStyle("#44AA99", "<", (0, (1, 1))),
    "MEKF_LEVER": SchemeStyle("#DDCC77", ">", (0, (3, 1, 1, 1))),
    "PENDULUM": SchemeStyle("#332288", "D", (0, (8, 3))),
    "FIXED_LAG": SchemeStyle("#CC79A7", "X", "-"),
    "SMOOTHER": SchemeStyle("#AA4499", "h", (0, (5, 1))),
    "DOUBLE_INTEGRATION": SchemeStyle("#661100", "H", (0, (2, 1, 1, 1))),
    "TOTAL_STATIONS": SchemeStyle("#E69F00", "^", (0, (4, 2))),
}
