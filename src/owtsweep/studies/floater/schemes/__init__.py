"""The estimation schemes of the floater study, one file each."""

from __future__ import annotations

from importlib import import_module

from owtsweep.studies.floater.contract import Scheme
from owtsweep.studies.scheme_names import check_names

#: Name -> description, in the order of tables and figures. The scheme KF is `SCHEME` in the module
#: `kf`, and so on.
REGISTERED = {
    "KF_STEADY": "steady-state Kalman predictor as printed (Eqs. 16 to 18)",
    "KF": "time-varying Kalman predictor as printed (Eqs. 11 to 14)",
    "KF_CONSISTENT": "KF with process noise on velocities, as noisy accelerations make it",
    "KF_BIAS": "KF_CONSISTENT with a bias of each acceleration as a state",
    "KF_DELAY": "KF_CONSISTENT at the time of the report, then predicted to now",
    "KF_REPAIRED": "KF_CONSISTENT with both: bias as a state, delay compensated",
    "ERROR_STATE": "error-state Kalman filter with quaternion attitude, for large angles",
    "PASSIVE_OBSERVER": "non-linear passive observer on positions alone",
    "COMPLEMENTARY": "complementary filter: positions below, accelerations above a frequency",
    "LOWPASS": "low-pass filter and numerical differentiation of positions",
    "FIXED_LAG": "KF_REPAIRED and a smoother that looks a fixed time ahead",
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
