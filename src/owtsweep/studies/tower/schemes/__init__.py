"""The estimation schemes of the tower study; variants stand beside their base."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base.schemes import Listed, SchemeTable

#: Blue to green: augmented filters on the substructure. Red to violet: other filters there. Orange
#: to yellow: filters on the whole turbine. Grey, olive and brown: no filters.
LISTED = {
    "AKF": Listed(
        "augmented Kalman filter on the substructure, no wave input (p_1)",
        SchemeStyle("#0072B2", "o", "-"),
        simplicity=28,  # AKF_STEADY; initial variance, 2 sizes of loads
    ),
    "AKF_WAVE": Listed(
        "AKF with a triangular wave load as a further input (p_2)",
        SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
        simplicity=32,  # 31: AKF; the wave load, its walk and size; moved by the tie
    ),
    "AKF_STEADY": Listed(
        "AKF with the gain of the steady state from the first step on",
        SchemeStyle("#8FA8C8", "P", (0, (2, 2))),
        simplicity=25,  # 16 states, 4 loads; process, 2 walks, 2 kinds of sensors
    ),
    "AKF_LAGGED": Listed(
        "AKF and a smoother that looks a fixed time ahead",
        SchemeStyle("#332288", "s", (0, (4, 2))),
        simplicity=1029,  # AKF; the lag; late
    ),
    "AKF_MATERN12": Listed(
        "latent interface loads with an exponential correlation (Matern 1/2)",
        SchemeStyle("#44AA99", "<", (0, (1, 1))),
        simplicity=26,  # 16 states, 4 loads; process, 2 sizes, length, 2 kinds of sensors
    ),
    "AKF_MATERN32": Listed(
        "latent interface loads with smooth paths (Matern 3/2)",
        SchemeStyle("#117733", ">", (0, (8, 3))),
        simplicity=30,  # AKF_MATERN12; 4 rates of loads
    ),
    "GDF": Listed(
        "Gillijns and De Moor's joint input-state filter on the substructure",
        SchemeStyle("#CC79A7", "D", "-"),
        simplicity=20,  # 16 states; process noise, initial variance, noise of 2 kinds of sensors
    ),
    "DUAL": Listed(
        "dual Kalman filter on the substructure: inputs, then states",
        SchemeStyle("#882255", "X", (0, (4, 2))),
        simplicity=29,  # as AKF, a tie: DUAL runs two filters
    ),
    "AKF_WHOLE": Listed(
        "AKF on the whole turbine, with soil and rotor, loads at its top",
        SchemeStyle("#D55E00", "^", "-"),
        simplicity=31,  # 30: 20 states, 2 loads; as AKF; a tie: its model is larger
    ),
    "AKF_WHOLE_WAVE": Listed(
        "AKF_WHOLE with a triangular wave load as a further input",
        SchemeStyle("#E69F00", "h", (0, (6, 1, 1, 1))),
        simplicity=34,  # 33: AKF_WHOLE; the wave load, its walk and size; moved by the tie
    ),
    "KF_WHOLE": Listed(
        "Kalman filter on the whole turbine, its loads a slow part and white noise",
        SchemeStyle("#F0E442", "p", (0, (4, 2))),
        simplicity=33,  # 32: 20 states, 4 parts of loads, their sizes; 4 others; moved by the tie
    ),
    "MDE": Listed(
        "modal decomposition and expansion in three bands, offline",
        SchemeStyle("#999933", "d", "-"),
        simplicity=2004,  # two splits, order, margin; after the record
    ),
    "THRUST_LEVER": Listed(
        "thrust from one sensor, times the lever, static",
        SchemeStyle("#8C8C8C", "*", (0, (1, 2))),
        simplicity=1,  # no memory; the lever
    ),
    "QUASI_STATIC": Listed(
        "static shapes of the substructure through the inclinometers",
        SchemeStyle("#7A3B12", "8", (0, (3, 1, 1, 1, 1, 1))),
        simplicity=2,  # no memory; noise of two kinds of sensors
    ),
}
SHARED = {
    "akf": (
        "AKF_WAVE", "AKF_STEADY", "AKF_LAGGED", "AKF_MATERN12", "AKF_MATERN32", "AKF_WHOLE",
        "AKF_WHOLE_WAVE",
    ),
    "joint": ("GDF", "DUAL"),
    "static": ("THRUST_LEVER", "QUASI_STATIC"),
}  # fmt: skip
SCHEMES = SchemeTable("tower", __name__, LISTED, SHARED)
