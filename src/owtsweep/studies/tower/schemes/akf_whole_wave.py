"""AKF_WHOLE_WAVE: AKF_WHOLE with a triangular wave load as a further input, as in AKF_WAVE."""

from __future__ import annotations

from functools import partial

from owtsweep.studies.tower.models import model_whole
from owtsweep.studies.tower.schemes.akf import tune
from owtsweep.studies.tower.schemes.akf_wave import needs_water
from owtsweep.studies.tower.schemes.filtered import FilterScheme

SCHEME = FilterScheme(
    "AKF_WHOLE_WAVE", needs_water("AKF_WHOLE_WAVE", partial(model_whole, wave=True)), tune
)
