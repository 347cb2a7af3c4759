"""The cells of the floater study's grid, each with all six conditions."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from owtsweep.studies.base.axes import Cell, list_cells

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig


@dataclass(frozen=True)
class Conditions:
    """One cell: a value of each axis of the grid.

    Attributes
    ----------
    delay
        Delay of the optical system in samples.
    bias
        Bias of the accelerometers, as a part of the acceleration's standard deviation.
    snr
        Signal-to-noise ratio in dB.
    loss
        Share of optical reports that is lost.
    believed
        Variance R that schemes believe, over the true one.
    roll
        Standard deviation of the roll angle in degrees; None: that of the motion.
    """

    delay: float
    bias: float
    snr: float
    loss: float
    believed: float
    roll: float | None

    @classmethod
    def of(cls, cell: Cell) -> Conditions:
        """Return a cell in which an axis without a value is missing."""
        return cls(**{field.name: cell.get(field.name) for field in fields(cls)})  # type: ignore[arg-type]


def list_cases(config: FloaterConfig) -> list[Conditions]:
    """Return all cells of a configuration, the last axis running fastest."""
    axes = [field.name for field in fields(Conditions)]
    return [Conditions.of(cell) for cell in list_cells(axes, config.grid)]
