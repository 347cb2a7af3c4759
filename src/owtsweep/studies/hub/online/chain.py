"""Makes an online estimator from the settings of the parts that a scheme has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from owtsweep.studies.hub.fix_rules import FixRule, make_fix_rule
from owtsweep.studies.hub.known import ZERO, Sensors
from owtsweep.studies.hub.models import axis_filter, input_model
from owtsweep.studies.hub.online.coordinates import check_origin, start_at_first_fix
from owtsweep.studies.hub.online.estimator import OnlineEstimator
from owtsweep.studies.hub.online.registers import filter_settings, horizon_settings

if TYPE_CHECKING:
    from owtsweep.studies.hub.horizon import Horizon
    from owtsweep.studies.hub.scheme_sections import FilterTuning


def online_chain(
    tuning: FilterTuning,
    sensors: Sensors,
    *,
    window: int = 0,
    delay: int | None = None,
    mhe: Horizon | None = None,
    solver: str = "qrqp",
    hold: str = "zero",
    origin: ArrayLike | None = ZERO,
) -> OnlineEstimator:
    """Make a new online estimator from settings: [MHE ->] filter [-> smoother -> predictor].

    Parts in brackets may be absent.

    Parameters
    ----------
    tuning
        The filter's tuning.
    window
        Length N_s of the smoother's window, in steps.
    delay
        Number of steps by which the specific force is delayed in register 1 of Ren et al. (2019).
        The predictor predicts over these steps and the smoother's window. None means that there is
        no predictor: the filter takes the specific force without delay, and the filter's state is
        the estimate.
    mhe
        The moving horizon estimator; None for a scheme without one.
    solver
        Name of the solver for the MHE's windows that break a constraint.
    hold
        What the predictor's input does between samples, one of `estimation.discretisation.HOLDS`.
    origin
        The point about which the scheme starts from zero, shape (2,), m in NED; None for the first
        fix, whose noise is then the uncertainty of the first position.

    Raises
    ------
    InputError
        If the origin is not two finite numbers.
    """
    point = check_origin(origin)
    axis = axis_filter(tuning, sensors)
    if point is None:
        axis, mhe = start_at_first_fix(axis, mhe)
    predict = None if delay is None else input_model(tuning, sensors, hold)
    # an MHE weighs the fixes itself; the filter then takes the positions of the MHE as they are
    fix_rule = make_fix_rule(tuning) if mhe is None else FixRule()
    settings = filter_settings(
        axis, sensors, tuning.update_rule, delay or 0, window, predict, fix_rule
    )
    return OnlineEstimator(sensors, settings, horizon_settings(mhe, sensors), mhe, solver, point)
