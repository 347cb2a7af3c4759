"""Makes the rows of a block of a contest: what schemes' estimates of records are worth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.results.status import OK
from owtsweep.studies.base.contest import WINDOW

if TYPE_CHECKING:
    import pandas as pd


class Judgement(NamedTuple):
    """What a scheme's estimates of a record are worth: measure -> value, or why there are none."""

    found: dict[str, float]
    status: str = OK
    reason: str = ""

    @classmethod
    def none(cls, status: str, reason: str) -> Judgement:
        """Return that of a scheme that has no estimates."""
        return cls({"": float("nan")}, status, reason)


def make_rows(
    content: Mapping[str, Any],
    axes: Sequence[str],
    replicates: Sequence[int],
    judged: Sequence[Judgement],
) -> pd.DataFrame:
    """Return the rows of a block, one per record and measure; an axis that is not set is NaN.

    Parameters
    ----------
    content
        The block's content, with its scheme and the values of axes.
    axes
        The names of all axes.
    replicates, judged
        The numbers of the records, and what the scheme's estimates of each are worth.
    """
    import pandas as pd

    counts = [len(part.found) for part in judged]
    status = np.repeat([part.status for part in judged], counts)
    values = {axis: content.get(axis) for axis in axes}
    cell = {axis: np.nan if value is None else float(value) for axis, value in values.items()}
    return pd.DataFrame(
        {
            **cell,
            "scheme": content["scheme"],
            "replicate": np.repeat(replicates, counts),
            "measure": [name for part in judged for name in part.found],
            "window": np.where(status == OK, WINDOW, ""),
            "value": [value for part in judged for value in part.found.values()],
            "status": status,
            "reason": np.repeat([part.reason for part in judged], counts),
        }
    )
