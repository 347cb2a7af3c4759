"""The cells (natural period, amplitude) of Ren et al. (2019), and a run's results in the cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, cast

import pandas as pd

from experiments.ren2019.published import BOUNDARIES
from owtsweep.arrays import Array
from owtsweep.results.status import OK
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import scheme_names
from owtsweep.studies.hub.worlds import BOUNDARY
from owtsweep.sweep.runs import Run
from owtsweep.sweep.scores import collect_scores
from owtsweep.verdicts.inference import Estimate
from owtsweep.verdicts.judge import find_best
from owtsweep.verdicts.score_table import Boundary, ScoreTable

#: The grid of the paper's sections 5.3 and 5.4: natural periods (s), amplitudes (m), schemes.
PERIODS = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
AMPLITUDES = (0.05, 0.1, 0.2, 0.5, 0.7, 1.0, 2.0, 3.0, 7.0, 10.0)
SCHEMES = ("EKF", "MKF", "HME1", "HME2")


class Cell(NamedTuple):
    """A cell, which is a point of the grid: natural period (s) and amplitude (m)."""

    natural_period: float
    amplitude: float

    def __str__(self) -> str:
        return f"{self.natural_period:g} s, {self.amplitude:g} m"


#: Conditions of tables 6-9.
TABLE_CELLS = {6: Cell(4.0, 0.2), 7: Cell(8.0, 0.2), 8: Cell(8.0, 1.0), 9: Cell(3.0, 2.0)}


#: A published boundary is known to a factor of 2, because it is read off a logarithmic axis: the
#: paper's amplitudes on either side of the boundary are 0.2 and 0.5 m at 4 s, 0.7 and 2 m at 6 s.
TOLERANCE = 2.0


def tolerated(period: float) -> tuple[float, float]:
    """Return the least and greatest amplitude (m) that agree with the published boundary.

    `period` is a natural period at which a boundary is published: 4 or 6 s.
    """
    return BOUNDARIES[period] / TOLERANCE, BOUNDARIES[period] * TOLERANCE


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The results of a hub run, with which the published results are compared.

    Attributes
    ----------
    rows, schemes
        The run's rows of results, and its schemes.
    scores
        Its scores, averaged over the part of each record that `window` names.
    window
        "full" or "settled".
    criterion
        The measure by which schemes are ranked.
    """

    rows: pd.DataFrame
    schemes: tuple[str, ...]
    scores: ScoreTable
    window: str
    criterion: str = "position"

    @classmethod
    def of_run(cls, run: Run) -> Evidence:
        """Return the evidence of a run of one tuning."""
        config = cast(HubConfig, run.config)
        return cls(
            rows=run.cases(),
            schemes=tuple(scheme_names(config)),
            scores=collect_scores(run),
            window=config.measures.window,
        )

    @property
    def finished(self) -> pd.DataFrame:
        """The run's rows with the status "ok", for all windows (parts of records)."""
        return self.rows[self.rows["status"] == OK]

    @property
    def along_x(self) -> Evidence:
        """The same results, with schemes ranked by the MSE of x alone instead of x + y."""
        return replace(self, criterion="x")

    @property
    def boundaries(self) -> dict[float, Boundary]:
        """Natural period (s) -> amplitude below which HME2 has less MSE, and above it HME1.

        The dict is empty if the run lacks one of the two schemes, or was not run with
        evaluation=superposed.
        """
        found = self.scores.run.find_boundaries(BOUNDARY, self.criterion) if self.scores.run else {}
        return {float(place[0]): boundary for place, boundary in found.items()}

    @property
    def growth(self) -> Estimate | None:
        """The boundary at a natural period of 8 s over that at 4 s; None if the run has none."""
        run = self.scores.run
        return run and run.divide(((8.0,), (4.0,)), BOUNDARY, self.criterion)

    def common(self, keys: Sequence[tuple[str, Cell, str]]) -> list[Array] | None:
        """Return the values of several (scheme, cell, measure) in the records that have all."""
        return self.scores.find(
            [
                {"scheme": scheme, "measure": measure, **cell._asdict()}
                for scheme, cell, measure in keys
            ]
        )

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """Return a scheme's values of a measure in a cell, shape (records,); None without any."""
        values = self.common([(scheme, cell, measure)])
        return None if values is None else values[0]

    def rank(self, cell: Cell, *, other_than: str = "") -> tuple[str, list[Array]] | None:
        """Return the scheme of least mean in a cell, and the values of all, as in `SCHEMES`.

        The scheme `other_than` is left out with those that coincide with it. None if a scheme is
        not in this run, or none is left.
        """
        values = self.common([(scheme, cell, self.criterion) for scheme in SCHEMES])
        if values is None:
            return None
        best = find_best(values, other_than=SCHEMES.index(other_than) if other_than else None)
        return None if best is None else (SCHEMES[best], values)
