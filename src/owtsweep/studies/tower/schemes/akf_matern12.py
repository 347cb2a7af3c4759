"""AKF_MATERN12: latent interface loads, Gaussian processes with the kernel Matern 1/2.

The loads have an exponential correlation: walks that are pulled back to zero. Size and correlation
time are the tuning's `sigma` and `length`. Simpson et al. (2025, section 3) name such latent
force models as the way to go beyond the random walk of Eq. (23).
"""

from __future__ import annotations

from functools import partial

from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.schemes.filtered import FilterScheme
from owtsweep.studies.tower.schemes.latent import tune

SCHEME = FilterScheme("AKF_MATERN12", model_cut, partial(tune, kernel="matern12"), any_input=False)
