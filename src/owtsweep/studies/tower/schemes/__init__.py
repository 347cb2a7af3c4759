"""The estimation schemes of the tower study, one file each."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from owtsweep.studies.scheme_names import check_names
from owtsweep.studies.tower.contract import Scheme

#: Name -> description, in the order of tables and figures. The scheme AKF is `SCHEME` in the module
#: `akf`, and so on.
REGISTERED = {
    "AKF": "augmented Kalman filter on the substructure, no wave input (p_1)",
    "AKF_WAVE": "AKF with a triangular wave load as a further input (p_2)",
    "AKF_STEADY": "AKF with the gain of the steady state from the first step on",
    "AKF_LAGGED": "AKF and a smoother that looks a fixed time ahead",
    "AKF_MATERN12": "latent interface loads with an exponential correlation (Matern 1/2)",
    "AKF_MATERN32": "latent interface loads with smooth paths (Matern 3/2)",
    "GDF": "Gillijns and De Moor's joint input-state filter on the substructure",
    "DUAL": "dual Kalman filter on the substructure: inputs, then states",
    "AKF_WHOLE": "AKF on the whole turbine, with soil and rotor, loads at its top",
    "AKF_WHOLE_WAVE": "AKF_WHOLE with a triangular wave load as a further input",
    "KF_WHOLE": "Kalman filter on the whole turbine, its loads a slow part and white noise",
    "MDE": "modal decomposition and expansion in three bands, offline",
    "THRUST_LEVER": "thrust from one sensor, times the lever, static",
    "QUASI_STATIC": "static shapes of the substructure through the inclinometers",
}


def resolve(name: str) -> Scheme:
    """Return the scheme with a name of `REGISTERED`.

    Raises
    ------
    InputError
        If there is no scheme with this name.
    """
    check_names([name], REGISTERED)
    scheme: Scheme = import_module(f"{__name__}.{name.lower()}").SCHEME
    return scheme


def resolve_all(names: Sequence[str]) -> list[Scheme]:
    """Return the schemes with these names, in their order.

    Raises
    ------
    InputError
        As `check_names` says.
    """
    check_names(names, REGISTERED)
    return [resolve(name) for name in names]
