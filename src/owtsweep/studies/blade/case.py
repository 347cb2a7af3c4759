"""The cells of the blade study's grid, each with all its conditions."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from owtsweep.studies.base.axes import Cell, list_cells

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig


@dataclass(frozen=True)
class Conditions:
    """One cell: a value of each axis of the grid; None: that of the section `motion`.

    Attributes
    ----------
    sigma
        Standard deviation of a GNSS fix in m, horizontal.
    outage
        Length of an outage in s.
    offset
        By what time stamps of GNSS come late, s.
    period, amplitude
        Natural period (s) and standard deviation (m) of the longitudinal swing.
    lever
        Error of the antenna's place in m.
    heading
        Standard deviation of the heading in degrees.
    """

    sigma: float
    outage: float
    offset: float
    period: float | None
    amplitude: float | None
    lever: float
    heading: float | None

    @classmethod
    def of(cls, cell: Cell) -> Conditions:
        """Return a cell in which an axis without a value is missing."""
        return cls(**{field.name: cell.get(field.name) for field in fields(cls)})  # type: ignore[arg-type]


def list_cases(config: BladeConfig) -> list[Conditions]:
    """Return all cells of a configuration, the last axis running fastest."""
    axes = [field.name for field in fields(Conditions)]
    return [Conditions.of(cell) for cell in list_cells(axes, config.grid)]
