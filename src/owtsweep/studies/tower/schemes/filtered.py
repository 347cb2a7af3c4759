"""What all schemes share that run one linear filter over a model: covariances, checks, estimates.

States are modal coordinates with modal masses of 1 and their rates, inputs are in units of the
model's `scale`. Noise of states is the tuning's one number for all of them (Q and P_0 of Simpson et
al. 2025, section 3); noise of inputs is the tuning's prior of the loads.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.augmented import augment
from owtsweep.estimation.input_state import Filter
from owtsweep.estimation.lagged import Lagged
from owtsweep.estimation.observability import Observability, find_unobservable
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.tower.contract import Estimates, Scheme, Setting
from owtsweep.studies.tower.models import WAVE, Model

#: A settled filter is unstable if an eigenvalue of its closed loop exceeds 1 by more.
BEYOND = 1e-9
#: Errors along an eigenvalue this near to 1 last for a day at 100 Hz.
MARGINAL = 1e-7
#: A mode is rigid if its strains, and unseen if its signals, are less than this part of the
#: largest.
RIGID = 1e-9


@dataclass(frozen=True)
class Filtered:
    """A filter made ready for one setting; `latency` in, s."""

    model: Model
    filter: Filter
    latency: float = 0.0

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        both = self.filter.run(measured)
        states = 2 * self.model.modes
        inputs = both[:, states : states + len(self.model.inputs)]
        return replace(self.model.read(both[:, :states], inputs), latency=self.latency)


@dataclass(frozen=True)
class FilterScheme(Scheme):
    """A scheme that consists of a model and of a filter on it, made by `model` and `tune`.

    ignores: axes of the knowledge on which neither model nor filter depends.
    any_input: whether inputs may be anything, so that sensors must tell all of them apart. Inputs
        that fade by themselves need not be seen.
    """

    name: str
    model: Callable[[Setting], Model]
    tune: Callable[[Setting, Model], Filter]
    ignores: Sequence[str] = ()
    any_input: bool = True

    def prepare(self, setting: Setting) -> Filtered:
        """Compute the gains for a setting.

        Raise `Unable` if the filter is unstable there, does not see how the structure is bent, or
        has a wave load where the structure stands in no water.
        """
        model = self.model(setting)
        if WAVE in model.inputs and not setting.wave_shape.any():
            raise Unable(
                f"{self.name} has no wave load to estimate: the structure stands in no water"
            )
        if self.any_input and (blindness := tell_blindness(setting, model)):
            raise Unable(f"{self.name} is blind: {blindness}")
        made = self.tune(setting, model)
        check_loop(self.name, setting, model, made.F)
        return Filtered(model, made, made.lag * setting.step if isinstance(made, Lagged) else 0.0)


class Noise(NamedTuple):
    """The covariances of a model's filter, as in Eq. (24); inputs are in the model's units.

    Q, S, R: of states, of the inputs' change, and of sensors, each per step; shapes (2 modes, 2
        modes), (inputs, inputs) and (channels, channels).
    P0: of states and inputs before the first step, shape (2 modes + inputs, 2 modes + inputs).
    size: Standard deviations of the inputs about zero, shape (inputs,).
    """

    Q: Array
    S: Array
    R: Array
    P0: Array
    size: Array


def find_noise(setting: Setting, model: Model) -> Noise:
    """Return the noise of a model by a setting's tuning."""
    tuning, size = setting.tuning, setting.priors.sigma[model.inputs] / model.scale
    initial = np.full(2 * model.modes, tuning.initial)
    return Noise(
        Q=np.diag(np.repeat([tuning.process_noise, setting.rate_noise], model.modes)),
        S=np.eye(len(size)),  # a step is the unit of its input
        R=np.diag([channel.sigma**2 for channel in setting.channels]),
        P0=np.diag(np.concatenate([initial, size**2])),
        size=size,
    )


def observe(model: Model) -> Observability:
    """Return what sensors see of a model's states and inputs, which may be anything (Eq. 22)."""
    return find_unobservable(*augment(model.discrete, np.eye(len(model.inputs))))


def tell_blindness(setting: Setting, model: Model) -> str:
    """Say how many directions of state and input that bend the structure sensors do not see.

    Directions that bend nothing may stay unseen: with inclinometers and accelerometers, position
    and velocity of the rigid translation drift. The sentence has the rank by the test of Popov,
    Belevitch and Hautus; it is "" if all that bends is seen.
    """
    observed = observe(model)
    bending = setting.strain @ model.basis
    size = np.linalg.norm(bending, axis=0).max()
    bent = 0
    for unseen in observed.unseen:
        strains = bending @ unseen.directions[: model.modes]
        bent += int(np.sum(np.linalg.svd(strains, compute_uv=False) > RIGID * size))
    if not bent:
        return ""
    return (
        f"the sensors see {observed.rank} of {observed.states} directions of state and input "
        f"(PBH rank), and {bent} of the others bend the structure"
    )


def check_loop(name: str, setting: Setting, model: Model, loop: Array) -> None:
    """Check that a settled filter forgets its errors, rigid motion that no sensor feels left out.

    `loop` is the filter's closed loop; its first 2 x modes states are those of the model. What the
    sensors do not feel keeps an eigenvalue of 1 there, whatever the gain is. Raise `Unable` if
    errors grow or never fade; the message has the spectral radius.
    """
    if not np.all(np.isfinite(loop)):
        raise Unable(f"{name} is unstable: its covariances grow beyond all bounds")
    kept = np.setdiff1d(np.arange(len(loop)), list_unseen_rigid(setting, model))
    radius = float(np.abs(np.linalg.eigvals(loop[np.ix_(kept, kept)])).max())
    if radius > 1.0 - MARGINAL:
        fate = "is unstable" if radius > 1.0 + BEYOND else "does not forget its errors"
        # Few digits: records differ in the others, and one line should tell of all.
        excess = f"above 1 by {radius - 1.0:.0e}" if radius > 1.0 + BEYOND else "1"
        raise Unable(f"{name} {fate}: the spectral radius of its closed loop is {excess}")


def list_unseen_rigid(setting: Setting, model: Model) -> list[int]:
    """Return the states of rigid motion that no channel sees: coordinates and their rates."""
    bending = np.linalg.norm(setting.strain @ model.basis, axis=0)
    G = np.abs(model.discrete.G)
    seen = np.max(G / G.max(axis=1, keepdims=True), axis=0)
    modes = model.modes
    return [
        state
        for mode in range(modes)
        if bending[mode] < RIGID * bending.max() and seen[mode] + seen[modes + mode] < RIGID
        for state in (mode, modes + mode)
    ]
