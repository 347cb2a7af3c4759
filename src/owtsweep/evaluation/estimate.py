"""The output of an estimator at one step: named quantities of any dimension."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from owtsweep.arrays import Array


class Quantity(NamedTuple):
    """A quantity that a study judges, such as position with the components x and y.

    Attributes
    ----------
    name
        The quantity's name in estimates and tables.
    components
        The names of the quantity's components in tables. An estimate of the quantity is an array
        with one number per component.
    """

    name: str
    components: tuple[str, ...]


#: Position and velocity in the plane: the quantities judged by default.
PLANAR_MOTION = (Quantity("position", ("x", "y")), Quantity("velocity", ("vx", "vy")))


class Innovation(NamedTuple):
    """The innovation of a step: a measurement minus the prediction of this measurement.

    `value` is the innovation, shape (m,); `covariance` is its covariance, shape (m, m).
    """

    value: Array
    covariance: Array


class Estimate:
    """An estimator's estimate of the present state: what `update` returns at each step.

    A study defines which quantities are judged, and the dimension and unit of each. The hub study,
    for example, judges position (m) and velocity (m/s), each of shape (2,), north and east:
    `Estimate(position, velocity)`. Other quantities are given by name, as in
    `Estimate(angle=..., strain=...)`. Each quantity becomes an attribute of its name.

    Parameters
    ----------
    position, velocity
        Two quantities that most studies judge; None if not estimated.
    covariance
        Covariance (n, n) of the errors of all judged quantities, one after the other in the study's
        order. From covariances the study computes NEES, the normalised estimation error squared.
        None means no covariance.
    innovation
        The innovation of this step's measurement. From innovations the study computes NIS, the
        normalised innovation squared. None means no innovation.
    quantities
        Further quantities by name.

    Attributes
    ----------
    quantities
        Name -> value of all quantities that were given.
    """

    __slots__ = ("covariance", "innovation", "quantities")
    quantities: Mapping[str, Array]

    def __init__(
        self,
        position: Array | None = None,
        velocity: Array | None = None,
        covariance: Array | None = None,
        innovation: Innovation | None = None,
        **quantities: Array,
    ) -> None:
        if velocity is not None:
            quantities = {"velocity": velocity, **quantities}
        if position is not None:
            quantities = {"position": position, **quantities}
        self.quantities = quantities
        self.covariance = covariance
        self.innovation = innovation

    def __getattr__(self, name: str) -> Array:
        # during unpickling `quantities` does not exist yet
        if name != "quantities" and name in self.quantities:
            return self.quantities[name]
        raise AttributeError(f"the estimate has no {name}")

    def __repr__(self) -> str:
        further = {"covariance": self.covariance, "innovation": self.innovation}
        said = ", ".join(f"{k}={v!r}" for k, v in {**self.quantities, **further}.items())
        return f"Estimate({said})"

    def _replace(self, **changes: Any) -> Estimate:
        """Return a copy of the estimate in which the attributes named in `changes` are replaced."""
        kept = {"covariance": self.covariance, "innovation": self.innovation}
        return Estimate(**{**self.quantities, **kept, **changes})
