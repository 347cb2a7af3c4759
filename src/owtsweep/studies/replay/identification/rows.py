"""Rows of results on a record's noise, the table made from them, and names of a second run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.replay.identification.of_record import UNITS, Estimated, Noise

if TYPE_CHECKING:
    import pandas as pd

#: Values of the column `noise` of the advice.
STATED, ESTIMATED = "stated", "estimated"
#: Value in the column `scheme` of rows on a record's noise.
NOISE = "noise_of_record"
#: Row of the table for innovations that are not Gaussian; its estimate is their excess kurtosis.
TAILS = "excess_kurtosis"
COLUMNS = ("file", "parameter", "unit", "source", "stated", "estimate", "low", "high", "inside")
_NUMBERS = ("stated", "estimate", "low", "high")


def name_second_run(scheme: str) -> str:
    """Return the name, in rows of results, of a scheme that was run with the estimated noise."""
    return f"{scheme} (estimated noise)"


def list_values(noise: Noise) -> Iterator[tuple[str, str, float, int]]:
    """Yield the numbers of a record's noise as (measure, window, value, 1).

    The measure is "source: parameter"; the window is "stated", "estimate", "low" or "high".
    Numbers that do not exist are left out.
    """
    for one in noise.parameters:
        numbers = asdict(one)
        for window in _NUMBERS:
            if np.isfinite(numbers[window]):
                yield (f"{one.source}: {one.parameter}", window, float(numbers[window]), 1)
    if noise.heavy_tails:
        yield (f"innovations: {TAILS}", "estimate", noise.heavy_tails, 1)


def tabulate_noise(rows: pd.DataFrame, files: Sequence[str]) -> pd.DataFrame:
    """Make the table of noise from a replay's rows of results, in the order of `files`."""
    import pandas as pd

    kept = rows[rows["scheme"] == NOISE]
    found = {(f, m, w): v for f, m, w, v in kept[["file", "measure", "window", "value"]].to_numpy()}
    lines = []
    for file in files:
        measures = {
            measure.partition(": ")[2]: measure for name, measure, _ in found if name == file
        }
        for parameter in [*UNITS, TAILS]:
            if parameter not in measures:
                continue
            measure = measures[parameter]
            source = measure.partition(": ")[0]
            numbers = [float(found.get((file, measure, w), np.nan)) for w in _NUMBERS]
            inside = Estimated(parameter, source, *numbers).inside
            unit = UNITS.get(parameter, "")
            lines.append((file, parameter, unit, source, *numbers, inside))
    return pd.DataFrame(lines, columns=list(COLUMNS))


def pick_second_run(rows: pd.DataFrame, schemes: Sequence[str]) -> pd.DataFrame:
    """Return the rows of the schemes' run with the estimated noise, under the schemes' names."""
    names = {name_second_run(scheme): scheme for scheme in schemes}
    kept = rows[rows["scheme"].isin(list(names))]
    return kept.assign(scheme=kept["scheme"].map(names))
