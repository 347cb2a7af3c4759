"""AKF and its variants: augmented Kalman filters whose unknown loads are random walks (Eq. 23).

AKF is that of Simpson et al. (2025), Algorithm 1, on the substructure: unknown are the loads at
both cuts. Neither soil nor rotor is modelled, and wave loads are left out (p_1). Algorithm 1 prints
P^-_{k-1} in the prediction, where P_{k-1} belongs.

- AKF_WAVE: a wave load as a further input (p_2). It falls linearly from sea level to the ground;
  its value at sea level is a random walk like the interface loads.
- AKF_STEADY: the gain of the steady state from the first step on.
- AKF_LAGGED: a smoother of fixed lag. Its latency is `tuning.lag` seconds, so it is online, but
  late. That makes up for the time lag of estimates from few accelerometers (section 5.3).
- AKF_WHOLE, AKF_WHOLE_WAVE: the model is the whole turbine, on the assumed soil and with the
  rotor-nacelle. Unknown are force and moment of the wind on its top, and the wave load as in
  AKF_WAVE. Interface loads follow from the motion (see `models`).
- AKF_MATERN12, AKF_MATERN32: latent interface loads, Gaussian processes with Matern kernels. With
  the kernel Matern 1/2 the loads have an exponential correlation: walks that are pulled back to
  zero. With Matern 3/2 they have smooth paths, whose rates are defined. Size and correlation time
  are the tuning's `sigma` and `length`. Simpson et al. (2025, section 3) name such latent force
  models as the way to go beyond the random walk of Eq. (23).
"""

from __future__ import annotations

from functools import partial
from typing import Literal

from owtsweep.estimation.augmented import make_augmented, make_lagged, make_steady
from owtsweep.estimation.input_state import Filter
from owtsweep.estimation.latent import make_latent
from owtsweep.studies.tower.contract import SOIL, Setting
from owtsweep.studies.tower.models import Model, model_cut, model_whole
from owtsweep.studies.tower.schemes.filtered import FilterScheme, find_noise


def tune(setting: Setting, model: Model) -> Filter:
    """Make the augmented Kalman filter of a model."""
    noise = find_noise(setting, model)
    return make_augmented(model.discrete, noise.Q, noise.S, noise.R, noise.P0)


def tune_steady(setting: Setting, model: Model) -> Filter:
    """Make the augmented Kalman filter of a model with its steady gain."""
    noise = find_noise(setting, model)
    return make_steady(model.discrete, noise.Q, noise.S, noise.R)


def tune_lagged(setting: Setting, model: Model) -> Filter:
    """Make the smoother of a model."""
    noise, lag = find_noise(setting, model), round(setting.tuning.lag / setting.step)
    return make_lagged(model.discrete, noise.Q, noise.S, noise.R, noise.P0, lag)


def tune_latent(setting: Setting, model: Model, kernel: Literal["matern12", "matern32"]) -> Filter:
    """Make the filter of a model, with the tuning's sizes and correlation times of loads."""
    noise, length = find_noise(setting, model), setting.priors.length[model.inputs]
    return make_latent(model.discrete, noise.Q, noise.R, kernel, noise.size, length)


SCHEME = FilterScheme("AKF", model_cut, tune, SOIL)
AKF_WAVE = FilterScheme("AKF_WAVE", partial(model_cut, wave=True), tune, SOIL)
AKF_STEADY = FilterScheme("AKF_STEADY", model_cut, tune_steady, SOIL)
AKF_LAGGED = FilterScheme("AKF_LAGGED", model_cut, tune_lagged, SOIL)
AKF_WHOLE = FilterScheme("AKF_WHOLE", model_whole, tune)
AKF_WHOLE_WAVE = FilterScheme("AKF_WHOLE_WAVE", partial(model_whole, wave=True), tune)
AKF_MATERN12 = FilterScheme(
    "AKF_MATERN12", model_cut, partial(tune_latent, kernel="matern12"), SOIL, any_input=False
)
AKF_MATERN32 = FilterScheme(
    "AKF_MATERN32", model_cut, partial(tune_latent, kernel="matern32"), SOIL, any_input=False
)
