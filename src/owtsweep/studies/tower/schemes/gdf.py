"""GDF: Gillijns and De Moor's joint input-state filter on the substructure.

Gillijns and De Moor (2007), with direct feedthrough. Nothing is believed of the inputs: each step
solves for them by least squares. So the accelerometers alone must tell all interface loads apart:
the feedthrough matrix J needs as many independent rows as there are inputs.
"""

from __future__ import annotations

import numpy as np

from owtsweep.estimation.gillijns import find_feedthrough_rank, make_gillijns
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.tower.contract import Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import (
    FilterScheme,
    Settled,
    noise_of_sensors,
    noise_of_states,
)


def tune(setting: Setting, model: Model) -> Settled:
    """Make the filter of a model.

    Raises
    ------
    Unable
        If the feedthrough matrix has too small a rank.
    """
    rank, inputs = find_feedthrough_rank(model.discrete.J), len(model.inputs)
    if rank < inputs:
        raise Unable(
            f"GDF is blind: the feedthrough matrix J has rank {rank}, but {inputs} inputs are "
            "unknown; it needs as many accelerometers at different heights"
        )
    initial = setting.tuning.initial * np.eye(2 * model.modes)
    return make_gillijns(
        model.discrete, noise_of_states(setting, model), noise_of_sensors(setting), initial
    )


SCHEME = FilterScheme("GDF", model_cut, tune)
