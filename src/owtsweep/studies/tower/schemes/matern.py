"""AKF_MATERN12 and AKF_MATERN32: latent interface loads, Gaussian processes with Matern kernels.

With the kernel Matern 1/2 the loads have an exponential correlation: walks that are pulled back to
zero. With Matern 3/2 they have smooth paths, whose rates are defined. Size and correlation time are
the tuning's `sigma` and `length`. Simpson et al. (2025, section 3) name such latent force models as
the way to go beyond the random walk of Eq. (23).
"""

from __future__ import annotations

from functools import partial
from typing import Literal

from owtsweep.estimation.latent import make_latent
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
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
        length=setting.priors.length[model.inputs],
    )


AKF_MATERN12 = FilterScheme(
    "AKF_MATERN12", model_cut, partial(tune, kernel="matern12"), any_input=False
)
AKF_MATERN32 = FilterScheme(
    "AKF_MATERN32", model_cut, partial(tune, kernel="matern32"), any_input=False
)
