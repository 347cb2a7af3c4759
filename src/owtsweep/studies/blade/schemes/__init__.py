"""The estimation schemes of the blade study, one file each."""

from __future__ import annotations

from importlib import import_module

from owtsweep.studies.blade.contract import Scheme
from owtsweep.studies.scheme_names import check_names

#: Name -> description, in the order of tables and figures. The scheme UKF is `SCHEME` in the
#: module `ukf`, and so on.
REGISTERED = {
    "HOLD": "the last GNSS fix, held",
    "GNSS_WAHBA": "three antennas and Wahba's problem, held between fixes",
    "COMPLEMENTARY": "fixed gains: attitude levelled by gravity, position corrected by fixes",
    "UKF": "unscented Kalman filter with 15 error states, as in the paper's system",
    "MEKF": "multiplicative extended Kalman filter with the same states",
    "INVARIANT_EKF": "left-invariant extended Kalman filter with the same states",
    "MEKF_HEADING": "MEKF with fixes of a second antenna, which show the heading",
    "MEKF_OFFSET": "MEKF with the offset of the GNSS clock, or its delay, as a state",
    "MEKF_LEVER": "MEKF with the error of the antenna's place as states",
    "PENDULUM": "MEKF that knows how the blade swings below a hook at rest",
    "FIXED_LAG": "MEKF and a smoother that looks a fixed time ahead",
    "SMOOTHER": "MEKF and a smoother of the whole record, what post-processing does",
    "DOUBLE_INTEGRATION": "accelerations integrated twice above .15 Hz, and fixes below it",
    "TOTAL_STATIONS": "three total stations and Wahba's problem, the paper's reference",
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
