"""Makes the settings and the registers (memory) of the online kernels for a new estimator."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array, make_rows
from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.gains import RULES
from owtsweep.estimation.mhe import square_root_information
from owtsweep.estimation.predictor import prediction_noise
from owtsweep.studies.hub.chain import predictor_arrays
from owtsweep.studies.hub.fix_rules import FIX_RULES, FixRule
from owtsweep.studies.hub.horizon import INPUTS, Horizon, growth_over, lean_terms
from owtsweep.studies.hub.kernels.layout import NO_LEAN, STATE
from owtsweep.studies.hub.kernels.online_layout import (
    COUNTERS,
    PLAIN,
    ROW,
    FilterSettings,
    HorizonSettings,
    OnlineRegisters,
)
from owtsweep.studies.hub.known import Sensors
from owtsweep.studies.hub.models import POSITION, AxisFilter


def filter_settings(
    axis: AxisFilter,
    sensors: Sensors,
    rule: str,
    delay: int,
    window: int,
    predict: Discrete | None,
    fix_rule: FixRule,
) -> FilterSettings:
    """Make the settings of filter, smoother and predictor for the online kernels.

    Parameters
    ----------
    axis
        The filter's model and variances for one axis.
    rule
        How a step without a position fix is treated, one of `estimation.gains.RULES`.
    delay, window
        Delay of the specific force, and length of the smoother's window, in steps.
    predict
        The predictor's model; None if the filtered state is the estimate.
    fix_rule
        How much the positions count that the filter gets.
    """
    steps = delay + window
    ahead: Array = np.eye(3)
    response: Array = np.zeros((1, 3))
    added: Array = np.zeros((3, 3))
    if predict is not None and steps > 0:
        noise = prediction_noise(predict, steps)
        ahead, response = noise.transition, noise.response
        added = noise.process + axis.force_variance * response.T @ response
    return FilterSettings(
        A=np.ascontiguousarray(axis.model.A),
        B=axis.model.B[:, 0].copy(),
        Q=axis.model.Q,
        slow=POSITION,
        h=axis.force_row,
        r_slow=axis.position_variance,
        r_fast=axis.force_variance,
        rule=RULES.index(rule),
        P0=axis.initial_covariance,
        fix_interval=sensors.fix_interval,
        delay=delay,
        window=window,
        predicts=predict is not None,
        predictor=predictor_arrays(predict, steps, sensors.step),
        ahead=np.ascontiguousarray(ahead),
        response=np.ascontiguousarray(response),
        added=np.ascontiguousarray(added),
        rotation=sensors.rotation,
        gravity=np.array(sensors.gravity),
        fix_rule=FIX_RULES.index(fix_rule.name),
        fix_limit=fix_rule.limit,
        fix_patience=fix_rule.patience,
    )


def horizon_settings(mhe: Horizon | None, sensors: Sensors) -> HorizonSettings:
    """Make the settings of the moving horizon estimator (MHE) for the online kernels.

    `mhe` is None for a scheme without an MHE; the settings then say so (`active` is false).
    """
    eye = np.eye(3)
    if mhe is None:
        free = np.full(3, np.inf)
        none = np.zeros((1, 2, 3))
        return HorizonSettings(
            False, 1, 1, 0, 0, sensors.step, eye, eye, 1.0, eye, False, free, none, NO_LEAN,
            PLAIN, np.inf,
        )  # fmt: skip
    return HorizonSettings(
        active=True,
        interval=mhe.interval,
        length=mhe.length,
        arrival=(2 if mhe.fixed else 1) if mhe.arrival else 0,
        inputs=INPUTS.index(mhe.inputs),
        step=sensors.step,
        transition=np.ascontiguousarray(mhe.weights.transition),
        link=np.ascontiguousarray(square_root_information(mhe.weights.link_covariance)),
        inverse_sigma=float(1.0 / np.sqrt(mhe.weights.fix_variance)),
        prior=np.ascontiguousarray(square_root_information(mhe.initial_covariance)),
        constrained=bool(np.any(np.isfinite(mhe.bounds))),
        bounds=mhe.bounds,
        growth=growth_over(mhe.lean, sensors, sensors.fix_interval),
        lean=lean_terms(mhe.lean, sensors.step),
        fix_rule=FIX_RULES.index(mhe.fix_rule.name),
        fix_limit=mhe.fix_rule.limit,
    )


def new_registers(f: FilterSettings, h: HorizonSettings) -> OnlineRegisters:
    """Make the registers of a new online estimator: zeros, except the filter's covariance, f.P0.

    f are the settings of filter, smoother and predictor; h are those of the moving horizon
    estimator. The algorithms of Ren et al. (2019) start from zero. The counter ROW is not zero: it
    starts behind the rows that stand for the time before the first step.
    """
    keep = f.delay + f.window + 2
    rows = 3 * keep + 64
    counter = np.zeros(COUNTERS, dtype=np.int64)
    counter[ROW] = keep  # rows before the first step are zero
    n = h.length
    return OnlineRegisters(
        counter=counter,
        P=f.P0.copy(),
        work=np.zeros((3, 4, 4)),
        predicted=np.zeros((1, 2)),
        given=np.zeros((1, 2)),
        force=np.zeros((rows, 2)),
        steps=make_rows(rows, 2, "r", "s", *STATE),
        K=np.zeros((rows, 4, 2)),
        C=np.zeros((rows, 4, 4)),
        Pm=np.zeros((rows, 4, 4)),
        Pf=np.zeros((rows, 4, 4)),
        back=make_rows(1, 2, "r", "s", *STATE),
        inputs=make_rows(1, 2, "p", "v"),
        estimate=make_rows(1, 2, "r", "s", *STATE),
        smoothed=np.zeros((f.window + 1, 4, 4)),
        coupling=np.zeros((f.window + 1, 4, 3)),
        no_coupling=np.zeros((4, 3)),
        zero=np.zeros((3, 2)),
        z=np.zeros((n + 1, 2)),
        have=np.zeros(n + 1, dtype=np.bool_),
        weight=np.ones(n + 1),
        effects=np.zeros((n, 3, 2)),
        states=np.zeros((n + 1, 3, 2)),
        covariances=np.zeros((n + 1, 3, 3)),
        now=make_rows(1, 2, "gathered", "sample", "p", "v"),
        prior=np.zeros((3, 3)),
        node=np.zeros((3, 2)),
        nodes=np.zeros((n + 2, 3, 2)),
        blocks=np.zeros((n, 3, 8)),
    )
