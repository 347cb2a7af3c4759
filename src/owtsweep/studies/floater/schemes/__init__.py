"""The estimation schemes of the floater study; variants stand beside their base."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base.schemes import Listed, SchemeTable

#: Red and orange: the paper's predictors. Blue to green: consistent filters, by what they know.
#: Violet: other observers. Grey and brown: no model of the motion.
LISTED = {
    "KF_STEADY": Listed(
        "steady-state Kalman predictor as printed (Eqs. 16 to 18)",
        SchemeStyle("#E69F00", "^", (0, (4, 2))),
        simplicity=27,  # 12 states; noise of positions, accelerations (6 each), rates (3)
    ),
    "KF": Listed(
        "time-varying Kalman predictor as printed (Eqs. 11 to 14)",
        SchemeStyle("#D55E00", "o", "-"),
        simplicity=33,  # KF_STEADY; 6 initial velocities
    ),
    "KF_CONSISTENT": Listed(
        "KF with process noise on velocities, as noisy accelerations make it",
        SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
        simplicity=39,  # KF; 6 initial positions
    ),
    "KF_BIAS": Listed(
        "KF_CONSISTENT with a bias of each acceleration as a state",
        SchemeStyle("#0072B2", "s", (0, (4, 2))),
        simplicity=57,  # KF_CONSISTENT; 6 biases, their sizes and walks
    ),
    "KF_DELAY": Listed(
        "KF_CONSISTENT at the time of the report, then predicted to now",
        SchemeStyle("#44AA99", "<", (0, (1, 1))),
        simplicity=40,  # KF_CONSISTENT; the delay
    ),
    "KF_REPAIRED": Listed(
        "KF_CONSISTENT with both: bias as a state, delay compensated",
        SchemeStyle("#117733", "P", "-"),
        simplicity=58,  # KF_BIAS; the delay
    ),
    "ERROR_STATE": Listed(
        "error-state Kalman filter with quaternion attitude, for large angles",
        SchemeStyle("#332288", "D", (0, (8, 3))),
        simplicity=44,  # 16 states; 18 of noise, 9 at the start, the delay
    ),
    "PASSIVE_OBSERVER": Listed(
        "non-linear passive observer on positions alone",
        SchemeStyle("#CC79A7", "X", "-"),
        simplicity=49,  # 30 states; 3 frequencies each, the damping
    ),
    "COMPLEMENTARY": Listed(
        "complementary filter: positions below, accelerations above a frequency",
        SchemeStyle("#882255", "p", (0, (2, 2))),
        simplicity=19,  # 2 states and a crossover for each; a tie, and needs the IMU
    ),
    "LOWPASS": Listed(
        "low-pass filter and numerical differentiation of positions",
        SchemeStyle("#8C8C8C", "*", (0, (1, 2))),
        simplicity=18,  # 2 states and a cut-off for each degree of freedom
    ),
    "FIXED_LAG": Listed(
        "KF_REPAIRED and a smoother that looks a fixed time ahead",
        SchemeStyle("#999933", "d", (0, (3, 1, 1, 1, 1, 1))),
        simplicity=1059,  # KF_REPAIRED; the lag; late
    ),
}
SHARED = {
    "printed": ("KF_STEADY", "KF"),
    "linear": ("KF_CONSISTENT", "KF_BIAS", "KF_DELAY", "KF_REPAIRED", "FIXED_LAG"),
    "positions_alone": ("PASSIVE_OBSERVER", "LOWPASS"),
}
SCHEMES = SchemeTable("floater", __name__, LISTED, SHARED)
#: Schemes that never take a roll angle for small.
LARGE_ANGLES = ("ERROR_STATE", "PASSIVE_OBSERVER", "LOWPASS")
