"""AKF_MATERN32: latent interface loads, Gaussian processes with the kernel Matern 3/2.

The loads have smooth paths, whose rates are defined. Size and correlation
time are the tuning's `sigma` and `length`. Simpson et al. (2025, section 3) name such latent
force models as the way to go beyond the random walk of Eq. (23).
"""

from __future__ import annotations

from functools import partial

from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.schemes.akf_matern12 import tune
from owtsweep.studies.tower.schemes.filtered import FilterScheme

SCHEME = FilterScheme("AKF_MATERN32", model_cut, partial(tune, kernel="matern32"), any_input=False)
