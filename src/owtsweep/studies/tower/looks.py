"""The colours, markers and lines of the tower study's schemes."""

from __future__ import annotations

from owtsweep.figures.palette import SchemeStyle

#: Blue to green: augmented filters on the substructure. Red to violet: other filters there. Orange
#: to yellow: filters on the whole turbine. Grey, olive and brown: no filters.
LOOKS = {
    "AKF": SchemeStyle("#0072B2", "o", "-"),
    "AKF_WAVE": SchemeStyle("#56B4E9", "v", (0, (6, 1, 1, 1))),
    "AKF_STEADY": SchemeStyle("#8FA8C8", "P", (0, (2, 2))),
    "AKF_LAGGED": SchemeStyle("#332288", "s", (0, (4, 2))),
    "AKF_MATERN12": SchemeStyle("#44AA99", "<", (0, (1, 1))),
    "AKF_MATERN32": SchemeStyle("#117733", ">", (0, (8, 3))),
    "GDF": SchemeStyle("#CC79A7", "D", "-"),
    "DUAL": SchemeStyle("#882255", "X", (0, (4, 2))),
    "AKF_WHOLE": SchemeStyle("#D55E00", "^", "-"),
    "AKF_WHOLE_WAVE": SchemeStyle("#E69F00", "h", (0, (6, 1, 1, 1))),
    "KF_WHOLE": SchemeStyle("#F0E442", "p", (0, (4, 2))),
    "MDE": SchemeStyle("#999933", "d", "-"),
    "THRUST_LEVER": SchemeStyle("#8C8C8C", "*", (0, (1, 2))),
    "QUASI_STATIC": SchemeStyle("#7A3B12", "8", (0, (3, 1, 1, 1, 1, 1))),
}
