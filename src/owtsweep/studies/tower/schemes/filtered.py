"""What all schemes share that run one linear filter over a model: covariances, checks, estimates.

States are modal coordinates with modal masses of 1 and their rates, inputs are in units of the
model's `scale`. Noise of states is the tuning's one number for all of them (Q and P_0 of Simpson et
al. 2025, section 3); noise of inputs is what the tuning believes of loads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.tower.contract import Estimates, Setting, Unable
from owtsweep.studies.tower.models import Model

#: A settled filter is unstable if an eigenvalue of its closed loop exceeds 1 by more.
BEYOND = 1e-9
#: Eigenvalues this near to 1 (or above) do not fade within hours.
MARGINAL = 1e-7
#: Least part of an eigenvector's coordinates that must deform the structure to count.
DEFORMING = 1e-5


class Settled(Protocol):
    """A filter with the closed loop x[k] = F x[k-1] + K y[k] after its gains have settled."""

    F: Array
    K: Array

    def run(self, y: Array) -> Array:
        """Return states, then inputs, for measurements (steps, channels)."""


@dataclass(frozen=True)
class Filtered:
    """A filter made ready for one setting."""

    model: Model
    filter: Settled

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        both = self.filter.run(measured)
        states = 2 * self.model.modes
        return self.model.read(
            both[:, :states], both[:, states : states + len(self.model.inputs)]
        )


@dataclass(frozen=True)
class FilterScheme:
    """A scheme that consists of a model and of a filter on it.

    Attributes
    ----------
    name
        Name of the scheme.
    knows_soil
        Whether the model holds the soil.
    model
        Makes the model.
    tune
        Makes the filter.
    linear
        Whether estimates are linear in the measurements.
    """

    name: str
    knows_soil: bool
    model: Callable[[Setting], Model]
    tune: Callable[[Setting, Model], Settled]
    linear: bool = True

    def prepare(self, setting: Setting) -> Filtered:
        """Compute the gains for a setting.

        Raises
        ------
        Unable
            If the filter is unstable there, or does not see how the structure is bent.
        """
        model = self.model(setting)
        made = self.tune(setting, model)
        check_bending(self.name, setting, model, made.F)
        return Filtered(model, made)


def noise_of_states(setting: Setting, model: Model) -> Array:
    """Return Q of Eq. (24), shape (2 modes, 2 modes)."""
    return setting.tuning.process_noise * np.eye(2 * model.modes)


def noise_of_inputs(setting: Setting, model: Model) -> Array:
    """Return S of Eq. (24) in the units of the model's inputs, shape (inputs, inputs)."""
    return np.diag((setting.believed.step_sigma[model.inputs] / model.scale) ** 2)


def noise_of_sensors(setting: Setting) -> Array:
    """Return R, shape (channels, channels)."""
    return np.diag([channel.sigma**2 for channel in setting.channels])


def size_of_inputs(setting: Setting, model: Model) -> Array:
    """Return the standard deviations about zero of the model's inputs in its units, (inputs,)."""
    return setting.believed.sigma[model.inputs] / model.scale


def prior(setting: Setting, model: Model) -> Array:
    """Return P_0 of states and inputs, shape (2 modes + inputs, 2 modes + inputs)."""
    states = np.full(2 * model.modes, setting.tuning.initial)
    return np.diag(np.concatenate([states, size_of_inputs(setting, model) ** 2]))


def check_bending(name: str, setting: Setting, model: Model, loop: Array) -> None:
    """Check that the errors of estimated curvatures fade in a settled filter.

    `loop` is the filter's closed loop; its first 2 x modes states are those of the model. A
    direction of state that the sensors do not see keeps its eigenvalue of 1 there, whatever the
    gain is. Such a direction is no harm as long as it does not bend the structure: with
    inclinometers and accelerometers, position and velocity of the rigid translation drift.

    Raises
    ------
    Unable
        If the errors grow (with the spectral radius), or stay for ever (with the number of unseen
        directions).
    """
    if not np.all(np.isfinite(loop)):
        raise Unable(f"{name} is unstable: its covariances grow beyond all bounds")
    values, vectors = np.linalg.eig(loop)
    bending = setting.strain @ model.basis
    per_mode = np.linalg.norm(bending, axis=0).max()
    coordinates = vectors[: model.modes]
    bent = np.linalg.norm(bending @ coordinates, axis=0)
    # An eigenvector may hold inputs or rates mainly: its own coordinates are the measure.
    asked = bent > DEFORMING * per_mode * np.linalg.norm(coordinates, axis=0)
    size = np.abs(values[asked])
    if np.any(size > 1.0 + BEYOND):
        raise Unable(
            f"{name} is unstable: the spectral radius of its closed loop is {size.max():.6f}, and "
            "errors of curvature grow with it"
        )
    unseen = int(np.sum(size > 1.0 - MARGINAL))
    if unseen:
        raise Unable(
            f"{name} is blind: the sensors leave {unseen} directions of state and input unseen "
            f"that bend the structure and do not fade; the observability matrix lacks "
            f"that much rank"
        )
