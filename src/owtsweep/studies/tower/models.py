"""State space of the substructure between the cuts, and of the whole structure.

Equations are those of Simpson et al. (2025), section 2.2. The state is x = [z, z'], with the modal
coordinates z of a reduced beam whose modal masses are 1:

    z'' + C z' + K z = basis' (loads p),      outputs y = G x + J p         (Eqs. 9 to 13).

Inputs are held over a step. Eq. (16) cannot be used for that, because A is singular when the
structure is free: `hold_inputs` takes the exponential of a block matrix.

The inputs p of a model are in units of their own (`scale`), their assumed change per step, so that
covariances hold numbers of one size. A model also says which loads act at the cuts, as a linear
function of state and inputs:

- Model of the substructure: these loads are the inputs.
- Model of the whole: the lower two are what the neighbour below (soil, foundation) puts on the
  substructure, from the motion there and the neighbour's matrices, which are those of the whole
  minus those of the substructure. The upper two follow from the balance of forces and of moments
  of the whole substructure: rigid motion r does the work r' (M u'' + C u' + K u) on inertia,
  damping and stiffness, and the loads at both cuts and the waves do the same work. No
  property of the rotor is used, and no higher derivative of modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.input_state import InputStateModel, hold_inputs
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.structures.reduction import Reduced, reduce_held
from owtsweep.studies.tower.contract import Channel, Estimates, Setting

#: The degrees of freedom of a cut structure on which F0, M0, F175, M175 act.
INTERFACES = [0, 1, -2, -1]
#: Number of the wave load q among the inputs F0, M0, F175, M175, q.
WAVE = 4


@dataclass(frozen=True)
class Model:
    """A structure as an estimator needs it, for one direction.

    discrete: Discrete state space: 2 x modes states; inputs divided by `scale`; the channels as
        outputs.
    scale: Units of the inputs in N, N m or N/m, shape (inputs,).
    inputs: Numbers of the inputs among F0, M0, F175, M175, q (as in `Priors`), shape (inputs,).
        For the whole structure, 2 and 3 stand for force and moment on its top.
    basis: Displacements of the degrees of freedom of the cut structure for unit modal coordinates,
        shape (dof, modes).
    loads_of_state, loads_of_input: Interface loads of the cut structure (N, N m) for unit states
        and unit scaled inputs, shapes (4, 2 modes) and (4, inputs).
    """

    discrete: InputStateModel
    scale: Array
    inputs: NDArray[np.int64]
    basis: Array
    loads_of_state: Array
    loads_of_input: Array

    @property
    def modes(self) -> int:
        return int(self.basis.shape[1])

    def read(self, states: Array, inputs: Array) -> Estimates:
        """Turn states (steps, 2 modes) and scaled inputs (steps, inputs) into estimates."""
        wave = self.inputs == WAVE
        return Estimates(
            displacement=states[:, : self.modes] @ self.basis.T,
            inputs=states @ self.loads_of_state.T + inputs @ self.loads_of_input.T,
            wave=inputs[:, wave] @ self.scale[wave] if np.any(wave) else None,
        )


def model_cut(setting: Setting, *, wave: bool = False) -> Model:
    """Model the substructure between the cuts under unknown loads at both.

    With `wave`, a wave load that falls linearly from sea level to the ground is a fifth input.
    """
    inputs = np.arange(5 if wave else 4)
    loads = np.zeros((len(setting.cut.mass), len(inputs)))
    loads[INTERFACES, np.arange(4)] = 1.0
    if wave:
        loads[:, WAVE] = setting.wave_shape
    scale, basis = setting.priors.step_sigma[inputs], setting.reduced.basis
    rate, drive = _accelerate(setting.reduced, setting.cut_damping, loads * scale)
    return Model(
        discrete=_discretise(setting, basis, rate, drive),
        scale=scale,
        inputs=inputs,
        basis=basis,
        loads_of_state=np.zeros((4, rate.shape[1])),
        loads_of_input=np.diag(scale)[:4],
    )


def model_whole(setting: Setting, *, wave: bool = False) -> Model:
    """Model the whole structure, with the assumed soil and rotor, under loads at its top.

    Inputs are force and moment on the top of the substructure from outside (wind), and with `wave`
    the wave load. The lowest `setting.whole_modes` modes are kept.
    """
    at = list_whole_dof(setting)
    inputs = np.array([2, 3, WAVE] if wave else [2, 3])
    loads = np.zeros((len(setting.whole.mass), len(inputs)))
    loads[at[-2:], [0, 1]] = 1.0
    if wave:
        loads[at, 2] = setting.wave_shape
    scale = setting.priors.step_sigma[inputs]
    reduced = reduce_held(setting.whole, setting.whole_modes)
    displaced, moving, accelerated = balance_loads(setting, reduced.basis)
    rate, drive = _accelerate(reduced, setting.whole_damping, loads * scale)
    of_state = accelerated @ rate + np.hstack([displaced, moving])
    of_input = accelerated @ drive
    if wave:
        of_input[2:, 2] -= balance_wave(setting) * scale[2]
    return Model(
        discrete=_discretise(setting, reduced.basis[at], rate, drive),
        scale=scale,
        inputs=inputs,
        basis=reduced.basis[at],
        loads_of_state=of_state,
        loads_of_input=of_input,
    )


def list_whole_dof(setting: Setting) -> Array:
    """Return the degrees of freedom of the whole at the cut's, shape (dof of the cut,)."""
    return np.stack([2 * setting.nodes, 2 * setting.nodes + 1], axis=1).reshape(-1)


def respond_statically(beam: PlaneBeam, loads: Array) -> Array:
    """Return the static displacements of a beam that stands, for loads of shape (dof, loads)."""
    result = np.zeros_like(loads)
    at = np.ix_(beam.free, beam.free)
    result[beam.free] = np.linalg.solve(beam.stiffness[at], loads[beam.free])
    return result


def balance_loads(setting: Setting, basis: Array) -> tuple[Array, Array, Array]:
    """Return the interface loads for unit displacement, velocity and acceleration of shapes.

    `basis` holds displacements of the whole structure for unit coordinates, (dof, shapes). The
    three results have the shape (4, shapes); their sum, each times its motion, is F0, M0, F175,
    M175. Waves are left out, see `balance_wave`. The module's head says which balance this is.
    """
    at, rigid = list_whole_dof(setting), move_rigidly(setting.cut)
    results = []
    for whole, cut in (
        (setting.whole.stiffness, setting.cut.stiffness),
        (setting.whole_damping, setting.cut_damping),
        (setting.whole.mass, setting.cut.mass),
    ):
        neighbour = whole[at[:2]].copy()
        neighbour[:, at] -= cut[:2]
        # Weight in the model softens elements of the cut; that is not the neighbour's doing.
        neighbour[:, at[2:]] = 0.0
        low = -neighbour @ basis
        work = rigid.T @ (cut @ basis[at]) - rigid[:2].T @ low
        results.append(np.vstack([low, np.linalg.solve(rigid[-2:].T, work)]))
    return results[0], results[1], results[2]


def balance_wave(setting: Setting) -> Array:
    """Return what a unit wave load takes from F175 and M175 in the balance, shape (2,)."""
    rigid = move_rigidly(setting.cut)
    return np.asarray(np.linalg.solve(rigid[-2:].T, rigid.T @ setting.wave_shape))


def move_rigidly(cut: PlaneBeam) -> Array:
    """Return the displacements of a unit translation, and of a unit rotation about the ground.

    The shape is (dof, 2).
    """
    rigid = np.zeros((len(cut.mass), 2))
    rigid[0::2, 0] = 1.0
    rigid[0::2, 1] = cut.heights - cut.heights[0]
    rigid[1::2, 1] = 1.0
    return rigid


def see(channel: Channel, shapes: Array, strain: Array) -> Array:
    """Return what a channel reads of unit coordinates, an accelerometer of their acceleration.

    `shapes`: displacements of the cut's degrees of freedom for unit coordinates, (dof, shapes).
    `strain`: strains for unit degrees of freedom, shape (nodes, dof). The result has the shape
    (shapes,).
    """
    if channel.kind == "strain":
        return np.asarray(strain[channel.node] @ shapes)
    return np.asarray(shapes[2 * channel.node + (channel.kind == "theta")])


def decompose(
    sensors: Sequence[Channel], weight: Array, shapes: Array, strain: Array
) -> tuple[int, Array]:
    """Return how many shapes sensors tell apart, and the coordinates of shapes for unit signals.

    By least squares with a `weight` of each sensor, shape (sensors,), and columns of one size.
    `shapes` and `strain` are as in `see`; coordinates have the shape (shapes, sensors).
    """
    seen = weight[:, None] * np.array([see(sensor, shapes, strain) for sensor in sensors])
    size = np.linalg.norm(seen, axis=0)
    size[size == 0.0] = 1.0
    rank = int(np.linalg.matrix_rank(seen / size))
    return rank, np.linalg.pinv(seen / size) * weight / size[:, None]


def _accelerate(reduced: Reduced, damping: Array, loads: Array) -> tuple[Array, Array]:
    """Return the acceleration of coordinates for unit states and unit inputs (Eq. 3).

    `damping` (dof, dof) and `loads` (dof, inputs) are those of the beam that is reduced.
    """
    own = reduced.basis.T @ damping @ reduced.basis
    return np.hstack([-reduced.stiffness, -own]), reduced.basis.T @ loads


def _discretise(setting: Setting, shapes: Array, rate: Array, drive: Array) -> InputStateModel:
    """Assemble Eqs. (11) and (13) and hold the inputs over a step.

    `shapes` (dof of the cut, modes) is what sensors see. The coordinates' acceleration is rate x +
    drive p; shapes (modes, 2 modes) and (modes, inputs).
    """
    modes, channels = len(rate), setting.channels
    A = np.vstack([np.eye(modes, 2 * modes, modes), rate])
    B = np.vstack([np.zeros_like(drive), drive])
    G, J = np.zeros((len(channels), 2 * modes)), np.zeros((len(channels), drive.shape[1]))
    for row, channel in enumerate(channels):
        shape = see(channel, shapes, setting.strain)
        if channel.kind == "a":
            G[row], J[row] = shape @ rate, shape @ drive
        else:
            G[row, :modes] = shape
    return hold_inputs(A, B, G, J, setting.step)
