"""AKF_STEADY: AKF with the gain of its steady state from the first step on."""

from __future__ import annotations

from owtsweep.estimation.augmented import make_steady
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noise_of_inputs,
    noise_of_sensors,
    noise_of_states,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the steady-state augmented Kalman filter of a model."""
    return make_steady(
        model.discrete,
        noise_of_states(setting, model),
        noise_of_inputs(setting, model),
        noise_of_sensors(setting),
    )


SCHEME = FilterScheme("AKF_STEADY", False, model_cut, tune)
