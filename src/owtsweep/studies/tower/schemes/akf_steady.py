"""AKF_STEADY: AKF with the gain of its steady state from the first step on."""

from __future__ import annotations

from owtsweep.estimation.augmented import make_steady
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noises_of_walks,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the steady-state augmented Kalman filter of a model."""
    return make_steady(model.discrete, *noises_of_walks(setting, model))


SCHEME = FilterScheme("AKF_STEADY", model_cut, tune)
