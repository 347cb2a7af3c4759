"""The estimation schemes of the blade study; variants stand beside their base."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base.schemes import Listed, SchemeTable

#: Grey and brown: no inertial unit. Blue: the filters that should agree. Green: what one of them
#: knows besides. Violet and red: those with a latency.
LISTED = {
    "HOLD": Listed(
        "the last GNSS fix, held",
        SchemeStyle("#B8AED0", "d", (0, (4, 2))),
        module="without_unit",
    ),
    "GNSS_WAHBA": Listed(
        "three antennas and Wahba's problem, held between fixes",
        SchemeStyle("#999933", "*", (0, (3, 1, 1, 1, 1, 1))),
        module="without_unit",
    ),
    "COMPLEMENTARY": Listed(
        "fixed gains: attitude levelled by gravity, position corrected by fixes",
        SchemeStyle("#882255", "p", (0, (2, 2))),
        module="fixed_gains",
    ),
    "UKF": Listed(
        "unscented Kalman filter with 15 error states, as in the paper's system",
        SchemeStyle("#D55E00", "o", "-"),
        module="unlike_mekf",
    ),
    "MEKF": Listed(
        "multiplicative extended Kalman filter with the same states",
        SchemeStyle("#0072B2", "s", (0, (4, 2))),
    ),
    "INVARIANT_EKF": Listed(
        "left-invariant extended Kalman filter with the same states",
        SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
        module="unlike_mekf",
    ),
    "MEKF_HEADING": Listed(
        "MEKF with fixes of a second antenna, which show the heading",
        SchemeStyle("#117733", "P", "-"),
        module="mekf",
    ),
    "MEKF_OFFSET": Listed(
        "MEKF with the offset of the GNSS clock, or its delay, as a state",
        SchemeStyle("#44AA99", "<", (0, (1, 1))),
        module="mekf",
    ),
    "MEKF_LEVER": Listed(
        "MEKF with the error of the antenna's place as states",
        SchemeStyle("#DDCC77", ">", (0, (3, 1, 1, 1))),
        module="mekf",
    ),
    "PENDULUM": Listed(
        "MEKF that knows how the blade swings below a hook at rest",
        SchemeStyle("#332288", "D", (0, (8, 3))),
        module="mekf",
    ),
    "FIXED_LAG": Listed(
        "MEKF and a smoother that looks a fixed time ahead",
        SchemeStyle("#CC79A7", "X", "-"),
        module="mekf",
    ),
    "SMOOTHER": Listed(
        "MEKF and a smoother of the whole record, what post-processing does",
        SchemeStyle("#AA4499", "h", (0, (5, 1))),
        module="mekf",
    ),
    "DOUBLE_INTEGRATION": Listed(
        "accelerations integrated twice above .15 Hz, and fixes below it",
        SchemeStyle("#661100", "H", (0, (2, 1, 1, 1))),
        module="fixed_gains",
    ),
    "TOTAL_STATIONS": Listed(
        "three total stations and Wahba's problem, the paper's reference",
        SchemeStyle("#E69F00", "^", (0, (4, 2))),
        module="without_unit",
    ),
}
SCHEMES = SchemeTable("blade", __name__, LISTED)
#: Schemes that are for a hook at rest.
HOOK_AT_REST = ("PENDULUM",)
