"""KF_WHOLE: a Kalman filter on the whole turbine whose loads are noise.

The textbook's plain Kalman filter takes loads for white noise with mean zero. The thrust has a
mean, and white noise that is wide enough to hold the mean would make the filter trust its model of
the motion less than the sensors allow. So each load is the sum of two parts:

- a slow one, an exponentially correlated process as large as the load itself (mean included), with
  a correlation time of `SLOW` seconds. The process is stable: where sensors see no mean (with
  accelerometers alone), the estimate stays at zero and does not drift.
- white noise, as strong at the model's first natural frequency f as the tuning's random walk: a
  walk with steps s at intervals h has there the spectral density of white noise with the standard
  deviation s / (2 pi f h).

The second part enters accelerometers directly, so noise of process and of measurement are
correlated; as a part of the state that is new at each step it is treated exactly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from owtsweep.estimation.augmented import augment, settle_at_once
from owtsweep.estimation.input_state import Filter
from owtsweep.structures.reduction import reduce_held
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_whole
from owtsweep.studies.tower.schemes.filtered import FilterScheme, find_noise

#: Correlation time of the loads' slow part, s: that of the wind's mean.
SLOW = 600.0


def model_twice(setting: Setting) -> Model:
    """Model the whole structure with each input twice: slow parts first, then white noise."""
    model = model_whole(setting)
    discrete = model.discrete
    return replace(
        model,
        discrete=replace(discrete, B=np.tile(discrete.B, (1, 2)), J=np.tile(discrete.J, (1, 2))),
        scale=np.tile(model.scale, 2),
        inputs=np.tile(model.inputs, 2),
        loads_of_input=np.tile(model.loads_of_input, (1, 2)),
    )


def tune(setting: Setting, model: Model) -> Filter:
    """Make the filter of a model with slow parts and white noise, with its steady gain.

    All of the model is stable, so the Riccati equation has a steady solution, which the
    time-varying gain would take minutes to reach.
    """
    given, (slow, white) = find_noise(setting, model), np.split(model.inputs, 2)
    first = reduce_held(setting.whole, 1).omega[0]
    noise = setting.priors.step_sigma[white] / (first * setting.step) / model.scale[: len(white)]
    sigma = np.concatenate([given.size[: len(slow)], noise])
    fade = np.concatenate([np.full(len(slow), np.exp(-setting.step / SLOW)), 0.0 * noise])
    F, H = augment(model.discrete, np.diag(fade))
    Q = block_diag(given.Q, np.diag((1.0 - fade**2) * sigma**2))
    return settle_at_once(F, H, Q, given.R)


SCHEME = FilterScheme("KF_WHOLE", model_twice, tune, any_input=False)
