"""AKF_WHOLE: the augmented Kalman filter on the whole turbine.

The model stands on the believed soil and carries the rotor-nacelle. Unknown are force and moment
of the wind on its top, as random walks. Interface loads follow from the motion (see `models`).
"""

from __future__ import annotations

from owtsweep.studies.tower.models import model_whole
from owtsweep.studies.tower.schemes.akf import tune
from owtsweep.studies.tower.schemes.filtered import FilterScheme

SCHEME = FilterScheme("AKF_WHOLE", model_whole, tune)
