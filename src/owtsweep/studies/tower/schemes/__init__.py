"""The estimation schemes of the tower study, one file each."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from owtsweep.errors import InputError
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
    check_names([name])
    scheme: Scheme = import_module(f"{__name__}.{name.lower()}").SCHEME
    return scheme


def resolve_all(names: Sequence[str]) -> list[Scheme]:
    """Return the schemes with these names, in their order.

    Raises
    ------
    InputError
        As `check_names` says.
    """
    check_names(names)
    return [resolve(name) for name in names]


def check_names(names: Sequence[str]) -> None:
    """Check that names are those of schemes in `REGISTERED`; import no scheme.

    Raises
    ------
    InputError
        If there is no name, an unknown name, or one name twice.
    """
    if not names:
        raise InputError("schemes: the list is empty; use e.g. schemes=[AKF,KF_WHOLE]")
    for name in names:
        if list(names).count(name) > 1:
            raise InputError(f"schemes: {name!r} stands there twice; use each name once")
        if name not in REGISTERED:
            raise InputError(f"schemes: there is no scheme {name!r}; use {', '.join(REGISTERED)}")
