"""DUAL: the dual Kalman filter on the substructure (Azam, Chatzi and Papadimitriou 2015).

One Kalman filter estimates the inputs, as random walks seen through the feedthrough of the
accelerometers; a second one takes these inputs as known and estimates the states. Neither knows the
other's covariance. On a structure that is free to move this loop is mostly unstable; the scheme
then says so.
"""

from __future__ import annotations

import numpy as np

from owtsweep.estimation.dual import make_dual
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noises_of_walks,
    size_of_inputs,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the dual filter of a model."""
    return make_dual(
        model.discrete,
        *noises_of_walks(setting, model),
        setting.tuning.initial * np.eye(2 * model.modes),
        np.diag(size_of_inputs(setting, model) ** 2),
    )


SCHEME = FilterScheme("DUAL", model_cut, tune)
