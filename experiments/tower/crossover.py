"""Ask how well the soil must be known: where a filter on the whole turbine beats the cut structure.

    python -m experiments.tower.crossover [FOLDER] [override ...]

The tower study is swept over the soil factor at 1 % noise, with ten records, for two set-ups of
sensors (sparse and dry), with wind alone and with waves. FOLDER (default: results/tower_crossover)
gets crossover.csv: the factors at which both filters are equally good, with 95 % intervals, by the
error of the base moment and by damage. Between two crossings the filter on the whole turbine is
better. A row "none" says which filter is better at all factors, or why one is unable to work.
Overrides go to all four sweeps.

The mean difference of the two schemes is interpolated between the values that were run, linearly in
the condition (in its logarithm, if that is the condition's scale). A crossing is a zero of it. The
confidence interval is that of the bootstrap: replicates are resampled, all values together, because
a replicate has the same motion and noise at all of them. (Where one computed result serves all
values of the condition, `owtsweep.results.boundary` finds the boundary without interpolation.)
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import owtsweep
from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.io.tables import write_table
from owtsweep.results.conditions import Condition
from owtsweep.results.status import OK, UNABLE
from owtsweep.statistics.inference import percentile_interval, resample_means
from owtsweep.streams import encode_value
from owtsweep.studies.base.contest import WINDOW
from owtsweep.studies.base.tables import spread
from owtsweep.studies.tower.contest import CONDITIONS

FACTORS = [0.5, 0.63, 0.8, 0.9, 0.95, 0.98, 1.0, 1.02, 1.05, 1.1, 1.25, 1.6, 2.0]
SENSORS = ("sparse_theta_a", "dry")
#: Sea -> filter on the cut structure, filter on the whole turbine.
PAIRS = {"calm": ("AKF", "AKF_WHOLE"), "waves": ("AKF_WAVE", "AKF_WHOLE_WAVE")}
CRITERIA = ("base_moment", "damage")
TUNING = "matched"
#: The columns of a table of crossings, after those of the other conditions.
COLUMNS = ("crossing", "ci_low", "ci_high", "better_above", "n")


def cross(sensors: str, sea: str, overrides: list[str]) -> pd.DataFrame:
    """Run one sweep; return its crossings, one line each, or one line that says who always wins."""
    cut, whole = PAIRS[sea]
    run = owtsweep.run(
        [
            "study=tower", f"sensors={sensors}", f"sea={sea}", f"tuning={TUNING}",
            f"schemes=[{cut},{whole}]", "grid.noise=[1]", f"grid.soil_factor={FACTORS}",
            "grid.replicates=10", *overrides,
        ]
    )  # fmt: skip
    rows = spread(run.cases(), "soil_factor", FACTORS)
    summary = run.summary()
    lines = []
    unable = rows[rows.status == UNABLE].drop_duplicates("scheme")
    if len(unable):
        told = {"sensors": sensors, "sea": sea, "tuning": TUNING, "cut": cut, "whole": whole}
        return pd.DataFrame([told | {"better_above": f"none: {unable.reason.iloc[0]}"}])
    for criterion in CRITERIA:
        found = find_crossings(rows, CONDITIONS, (whole, cut), criterion, WINDOW, "soil_factor")
        means = summary[summary.measure == criterion].pivot_table(
            "mean", "scheme", "soil_factor", aggfunc="first"
        )
        told = {
            "sensors": sensors, "sea": sea, "tuning": TUNING, "criterion": criterion,
            "cut": cut, "whole": whole, "error_cut": means.loc[cut, 1.0],
            "error_whole": means.loc[whole, 1.0],
        }  # fmt: skip
        if found.empty:
            best = means[1.0].idxmin()
            lines.append(pd.DataFrame([told | {"better_above": f"none: {best} is better at all"}]))
        else:
            lines.append(found.drop(columns="noise").assign(**told))
    return pd.concat(lines)


def find_crossings(
    rows: pd.DataFrame,
    conditions: Sequence[Condition],
    schemes: tuple[str, str],
    measure: str,
    window: str,
    along: str,
) -> pd.DataFrame:
    """Find the values of a condition at which two schemes have equal means, in each cell.

    A cell is one combination of the other conditions.

    Parameters
    ----------
    rows
        The rows of a run's cases, with a value of every condition.
    conditions
        The study's conditions.
    schemes
        Names of the two schemes.
    measure, window
        Names of the measure to compare (the smaller, the better), and of the part of the records.
    along
        Name of the condition.

    Returns
    -------
    DataFrame
        One row per crossing, sorted by cell and value: the other conditions, then `COLUMNS`.
        `ci_low` and `ci_high` are the ends of the 95 % confidence interval; they are NaN with a
        single replicate. Where resamples have no such crossing within the values that were run,
        they are infinite (`ci_low` of a logarithmic condition: 0). `better_above` is the scheme
        that is better above the crossing. `n` is the number of replicates that both schemes
        finished at all values. A cell without a crossing has no row: there one scheme is better at
        all values.

    Raises
    ------
    InputError
        If a scheme, the measure or the window is not among the rows, or the condition has fewer
        than two values.
    """
    condition = next(c for c in conditions if c.name == along)
    others = [c.name for c in conditions if c.name != along]
    chosen = rows[
        (rows["status"] == OK)
        & (rows["measure"] == measure)
        & (rows["window"] == window)
        & rows["scheme"].isin(schemes)
    ]
    for scheme in schemes:
        if not (chosen["scheme"] == scheme).any():
            raise InputError(f"schemes: {scheme} has no value of {measure} in window {window!r}")
    wide = chosen.pivot_table(
        "value", [*others, "replicate"], ["scheme", along], observed=True, sort=True
    )
    first, second = (wide[scheme] for scheme in schemes)
    levels = [level for level in first.columns if level in second.columns]
    if len(levels) < 2:
        raise InputError(f"grid.{along}: {len(levels)} value; a crossing needs two or more")
    difference = (first[levels] - second[levels]).dropna()
    places = np.array(levels, dtype=float)
    if condition.scale == "log":
        places = np.log(places)
    lines = []
    cells: Any = difference.groupby(level=others, sort=True) if others else [((), difference)]
    for cell, part in cells:
        values = part.to_numpy()
        key = [encode_value(value) for value in cell] or [0]
        resampled = resample_means(values, key)
        for place, rising in _cross(places, values.mean(axis=0)):
            low, high = _interval(places, resampled, place, rising)
            found = [place, low, high]
            if condition.scale == "log":
                found = [float(np.exp(value)) for value in found]
            # the first scheme's error minus the second's rises: above, the second is better
            lines.append((*cell, *found, schemes[1] if rising else schemes[0], len(values)))
    return pd.DataFrame(lines, columns=[*others, *COLUMNS])


def _cross(places: Array, means: Array) -> list[tuple[float, bool]]:
    """Return the zeros of a broken line, and whether the line rises there."""
    found = []
    for i in range(len(places) - 1):
        left, right = means[i], means[i + 1]
        if (left < 0.0) != (right < 0.0):
            part = left / (left - right)
            found.append((float(places[i] + part * (places[i + 1] - places[i])), bool(left < 0.0)))
    return found


def _interval(places: Array, resampled: Array, place: float, rising: bool) -> tuple[float, float]:
    """Return the ends of the interval of one crossing: of those nearest to it in each resample.

    A resample without such a crossing counts as infinite on both sides.
    """
    if not len(resampled):
        return np.nan, np.nan
    nearest = np.full(len(resampled), np.nan)
    for row, means in enumerate(resampled):
        same = [at for at, way in _cross(places, means) if way == rising]
        if same:
            nearest[row] = min(same, key=lambda at: abs(at - place))
    low, high = percentile_interval(nearest)
    return (-np.inf if np.isnan(low) else low), high


def main(folder: Path, overrides: list[str]) -> None:
    """Run all four sweeps, and write and print the table."""
    parts = [cross(sensors, sea, overrides) for sensors in SENSORS for sea in PAIRS]
    columns = [
        "sensors", "sea", "tuning", "criterion", "cut", "whole", "error_cut", "error_whole",
        "crossing", "ci_low", "ci_high", "better_above", "n",
    ]  # fmt: skip
    table = pd.concat(parts, ignore_index=True)[columns]
    folder.mkdir(parents=True, exist_ok=True)
    file = write_table(folder, "crossover", table)
    print(table.to_string(index=False))
    print(file)


if __name__ == "__main__":
    words = sys.argv[1:]
    place = words.pop(0) if words and "=" not in words[0] else "results/tower_crossover"
    main(Path(place), words)
