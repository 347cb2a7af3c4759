"""AKF_LAGGED: AKF and a smoother of fixed lag.

An estimate waits for `tuning.lag` seconds of later measurements, so it is online, but late. That
makes up for the time lag of estimates from few accelerometers (Simpson et al. 2025, section 5.3).
"""

from __future__ import annotations

from owtsweep.estimation.augmented import make_lagged
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noises_of_walks,
    prior,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the smoother of a model."""
    return make_lagged(
        model.discrete,
        *noises_of_walks(setting, model),
        prior(setting, model),
        round(setting.tuning.lag / setting.step),
    )


SCHEME = FilterScheme("AKF_LAGGED", model_cut, tune)
