"""AKF: the augmented Kalman filter on the substructure (Simpson et al. 2025, Algorithm 1).

Unknown loads at both cuts join the state as random walks (Eq. 23). Neither soil nor rotor is
modelled, and wave loads are left out (p_1). Algorithm 1 prints P^-_{k-1} in the prediction, where
P_{k-1} belongs.
"""

from __future__ import annotations

from owtsweep.estimation.augmented import make_augmented
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noises_of_walks,
    prior,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the augmented Kalman filter of a model."""
    return make_augmented(
        model.discrete,
        *noises_of_walks(setting, model),
        prior(setting, model),
    )


SCHEME = FilterScheme("AKF", model_cut, tune)
