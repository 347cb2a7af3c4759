"""GDF and DUAL: filters on the substructure that solve for inputs and states in two steps.

- GDF is Gillijns and De Moor's joint input-state filter (2007), with direct feedthrough. The inputs
  have no prior: each step solves for them by least squares. So the accelerometers alone must tell
  all interface loads apart: the feedthrough matrix J needs as many independent rows as there are
  inputs.
- DUAL is the dual Kalman filter (Azam, Chatzi and Papadimitriou 2015). One Kalman filter estimates
  the inputs, as random walks seen through the feedthrough of the accelerometers; a second one takes
  these inputs as known and estimates the states. Neither knows the other's covariance. On a
  structure that is free to move this loop is mostly unstable; the scheme then says so.
"""

from __future__ import annotations

from owtsweep.estimation.dual import make_dual
from owtsweep.estimation.gillijns import find_feedthrough_rank, make_gillijns
from owtsweep.estimation.input_state import Filter
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.tower.contract import SOIL, Setting
from owtsweep.studies.tower.models import Model, model_cut
from owtsweep.studies.tower.schemes.filtered import FilterScheme, find_noise


def tune_joint(setting: Setting, model: Model) -> Filter:
    """Make the joint filter of a model; `Unable` if the feedthrough matrix has too small a rank."""
    rank, inputs = find_feedthrough_rank(model.discrete.J), len(model.inputs)
    if rank < inputs:
        raise Unable(
            f"GDF is blind: the feedthrough matrix J has rank {rank}, but {inputs} inputs are "
            "unknown; it needs as many accelerometers at different heights"
        )
    noise, states = find_noise(setting, model), slice(2 * model.modes)
    return make_gillijns(model.discrete, noise.Q, noise.R, noise.P0[states, states])


def tune_dual(setting: Setting, model: Model) -> Filter:
    """Make the dual filter of a model."""
    noise, states = find_noise(setting, model), 2 * model.modes
    P0_x, P0_p = noise.P0[:states, :states], noise.P0[states:, states:]
    return make_dual(model.discrete, noise.Q, noise.S, noise.R, P0_x, P0_p)


GDF = FilterScheme("GDF", model_cut, tune_joint, SOIL)
DUAL = FilterScheme("DUAL", model_cut, tune_dual, SOIL)
