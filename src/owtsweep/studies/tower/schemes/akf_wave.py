"""AKF_WAVE: AKF with a wave load as a further input (Simpson et al. 2025, p_2).

The wave load falls linearly from sea level to the ground; its value at sea level is a random walk
like the interface loads.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from owtsweep.studies.base.contract import Unable
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.akf import tune
from owtsweep.studies.tower.schemes.filtered import FilterScheme


def needs_water(name: str, model: Callable[[Setting], Model]) -> Callable[[Setting], Model]:
    """Return a maker of models that says `Unable` where the structure stands in no water."""

    def make(setting: Setting) -> Model:
        if not setting.wave_shape.any():
            raise Unable(f"{name} has no wave load to estimate: the structure stands in no water")
        return model(setting)

    return make


SCHEME = FilterScheme("AKF_WAVE", needs_water("AKF_WAVE", partial(model_cut, wave=True)), tune)
