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
        simplicity=3,  # the last fix
    ),
    "GNSS_WAHBA": Listed(
        "three antennas and Wahba's problem, held between fixes",
        SchemeStyle("#999933", "*", (0, (3, 1, 1, 1, 1, 1))),
        simplicity=6,  # the last place and attitude
    ),
    "COMPLEMENTARY": Listed(
        "fixed gains: attitude levelled by gravity, position corrected by fixes",
        SchemeStyle("#882255", "p", (0, (2, 2))),
        simplicity=11,  # 9 states; crossover, levelling
    ),
    "UKF": Listed(
        "unscented Kalman filter with 15 error states, as in the paper's system",
        SchemeStyle("#D55E00", "o", "-"),
        simplicity=30,  # 29: MEKF; the spread of its points; moved by the tie
    ),
    "MEKF": Listed(
        "multiplicative extended Kalman filter with the same states",
        SchemeStyle("#0072B2", "s", (0, (4, 2))),
        simplicity=28,  # 15 errors; 3 of a fix, 3 of each sensor of the unit, 4 at the start
    ),
    "INVARIANT_EKF": Listed(
        "left-invariant extended Kalman filter with the same states",
        SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
        simplicity=29,  # as MEKF, a tie: MEKF is more common
    ),
    "MEKF_HEADING": Listed(
        "MEKF with fixes of a second antenna, which show the heading",
        SchemeStyle("#117733", "P", "-"),
        simplicity=32,  # 31: MEKF; the lever of a second antenna (3); moved by the tie
    ),
    "MEKF_OFFSET": Listed(
        "MEKF with the offset of the GNSS clock, or its delay, as a state",
        SchemeStyle("#44AA99", "<", (0, (1, 1))),
        simplicity=31,  # 30: MEKF; the offset, its size; moved by the tie
    ),
    "MEKF_LEVER": Listed(
        "MEKF with the error of the antenna's place as states",
        SchemeStyle("#DDCC77", ">", (0, (3, 1, 1, 1))),
        simplicity=33,  # 32: MEKF; 3 errors of place, their size; moved by the tie
    ),
    "PENDULUM": Listed(
        "MEKF that knows how the blade swings below a hook at rest",
        SchemeStyle("#332288", "D", (0, (8, 3))),
        simplicity=51,  # MEKF; 9 of the swing; 3 periods, dampings, sizes, gusts; 2 keys
    ),
    "FIXED_LAG": Listed(
        "MEKF and a smoother that looks a fixed time ahead",
        SchemeStyle("#CC79A7", "X", "-"),
        simplicity=1029,  # MEKF; the lag; late
    ),
    "SMOOTHER": Listed(
        "MEKF and a smoother of the whole record, what post-processing does",
        SchemeStyle("#AA4499", "h", (0, (5, 1))),
        simplicity=2028,  # MEKF; after the record
    ),
    "DOUBLE_INTEGRATION": Listed(
        "accelerations integrated twice above .15 Hz, and fixes below it",
        SchemeStyle("#661100", "H", (0, (2, 1, 1, 1))),
        simplicity=2013,  # COMPLEMENTARY; edge, padding; after the record
    ),
    "TOTAL_STATIONS": Listed(
        "three total stations and Wahba's problem, the paper's reference",
        SchemeStyle("#E69F00", "^", (0, (4, 2))),
        simplicity=1009,  # the last places of three prisms; late
    ),
}
SHARED = {
    "without_unit": ("HOLD", "GNSS_WAHBA", "TOTAL_STATIONS"),
    "fixed_gains": ("COMPLEMENTARY", "DOUBLE_INTEGRATION"),
    "unlike_mekf": ("UKF", "INVARIANT_EKF"),
    "mekf": ("MEKF_HEADING", "MEKF_OFFSET", "MEKF_LEVER", "PENDULUM", "FIXED_LAG", "SMOOTHER"),
}
SCHEMES = SchemeTable("blade", __name__, LISTED, SHARED)
