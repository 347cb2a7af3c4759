"""What passes between the parts of the tower study: what schemes know, and what they return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from owtsweep.arrays import Array
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.structures.reduction import Reduced
from owtsweep.studies.base import schemes
from owtsweep.studies.base.schemes import Knowledge
from owtsweep.studies.tower.tuning import Tuning

__all__ = ["DIRECTIONS", "INPUTS", "Estimates", "Scheme", "Setting"]

#: Directions of motion: fore-aft and side-side.
DIRECTIONS = ("fa", "ss")
#: Interface loads on the substructure, in the order of columns: force and moment at the lower cut,
#: then at the upper one.
INPUTS = ("F0", "M0", "F175", "M175")
#: What schemes ignore whose model holds no soil: they have one result for all of its values.
SOIL = ("soil_factor",)
#: What a channel measures: displacement (m), rotation (rad), acceleration (m/s^2), strain of the
#: outer fibre (no unit).
Kind = Literal["x", "theta", "a", "strain"]


@dataclass(frozen=True)
class Channel:
    """One sensor's signal in one direction: its kind, and its node of the cut structure.

    `sigma` is the standard deviation of the noise per sample, in the channel's unit.
    """

    kind: Kind
    node: int
    sigma: float


@dataclass(frozen=True)
class Priors:
    """The tuning's priors of the unknown loads; arrays of shape (5,): F0, M0, F175, M175, q.

    Forces are in N, moments in N m, the wave load q (at sea level) in N/m.

    step_sigma: Standard deviation of the change from sample to sample (a random walk's S, Eq. 24),
        above zero.
    sigma: Standard deviation about zero, mean included.
    length: Correlation time in s (of latent forces).
    """

    step_sigma: Array
    sigma: Array
    length: Array


@dataclass(frozen=True, eq=False)
class Setting(Knowledge):
    """All that a scheme may know of one direction of a case.

    direction: "fa" or "ss".
    cut, cut_damping, reduced: the substructure between the cuts, its damping matrix (kg/s, dof x
        dof), and its reduction.
    whole, whole_damping: the model of the whole structure, with the assumed soil, on a mesh that
        holds the nodes of `cut`; and its damping matrix.
    nodes: Numbers of the nodes of `cut` among those of `whole`, shape (nodes of cut,).
    wave_shape: Work-equivalent loads on the degrees of freedom of `cut` for q = 1 N/m, shape
        (dof,): a load that falls linearly from sea level to the ground (Simpson et al. 2025, p_2).
        Zero without water.
    strain: Strains of the outer fibre for unit degrees of freedom of `cut`, shape (nodes, dof).
    channels: the sensors, in the order of the measurements' columns.
    step: Sampling interval in s.
    priors: the tuning's priors of the loads.
    tuning: the numbers of all schemes.
    rate_noise: Variance per step of the rates of mass-normalised modes, kg m^2/s^2.
    whole_modes: Number of modes of the whole structure that models of it keep, lowest first.
    """

    direction: str
    cut: PlaneBeam
    cut_damping: Array
    reduced: Reduced
    whole: PlaneBeam
    whole_damping: Array
    nodes: Array
    wave_shape: Array
    strain: Array
    channels: tuple[Channel, ...]
    step: float
    priors: Priors
    tuning: Tuning
    rate_noise: float
    whole_modes: int = 10


@dataclass(frozen=True)
class Estimates:
    """What a scheme says about one direction of a record.

    displacement: All degrees of freedom of the cut structure (m, rad), shape (steps, dof).
    inputs: Interface loads on the cut structure in the order of `INPUTS` (N, N m), shape (steps,
        4).
    wave: Wave load q at sea level in N/m, shape (steps,); None if the scheme knows no waves.
    latency: Latency in s; the record's length if all of it is needed.
    """

    displacement: Array
    inputs: Array
    wave: Array | None = None
    latency: float = 0.0


class Scheme(schemes.Scheme[Setting, Array, Estimates]):
    """A scheme of the tower study; measurements have the shape (steps, channels)."""

    study = "tower"


@dataclass(frozen=True)
class Direct(schemes.Direct[Setting, Array, Estimates], Scheme):
    """A scheme by its name, by what makes it ready for a setting, and by the axes it ignores."""

    ignores: Sequence[str] = ()
