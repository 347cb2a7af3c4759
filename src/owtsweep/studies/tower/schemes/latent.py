"""Kalman filters whose inputs are Gaussian processes in time, for the schemes AKF_MATERN*."""

from __future__ import annotations

from typing import Literal

from owtsweep.estimation.latent import make_latent
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model
from owtsweep.studies.tower.schemes.filtered import (
    Settled,
    noise_of_sensors,
    noise_of_states,
    size_of_inputs,
)


def tune(setting: Setting, model: Model, kernel: Literal["matern12", "matern32"]) -> Settled:
    """Make the filter of a model, with the tuning's sizes and correlation times of loads."""
    return make_latent(
        model.discrete,
        noise_of_states(setting, model),
        noise_of_sensors(setting),
        kernel=kernel,
        sigma=size_of_inputs(setting, model),
        length=setting.believed.length[model.inputs],
    )
