"""Ask how well the soil must be known: where a filter on the whole turbine beats the cut structure.

    python -m experiments.tower.crossover [FOLDER] [override ...]

The tower study is swept over the soil factor at 1 % noise, with ten records, for two set-ups of
sensors (sparse and dry), with wind alone and with waves. FOLDER (default: results/tower_crossover)
gets crossover.csv: the factors at which both filters are equally good, with 95 % intervals, by the
error of the base moment and by damage. Between two crossings the filter on the whole turbine is
better. A row "none" says which filter is better at all factors, or why one is unable to work.
Overrides go to all four sweeps.

The mean difference of the two schemes is interpolated between the values that were run, linearly in
the logarithm of the factor. A crossing is a zero of it. The
confidence interval is that of the bootstrap: replicates are resampled, all values together, because
a replicate has the same motion and noise at all of them. (Where one computed result serves all
values of the condition, `owtsweep.results.boundary` finds the boundary without interpolation.)
"""

import numpy as np
import pandas as pd

import owtsweep
from experiments.command import read_words, write
from owtsweep.arrays import Array
from owtsweep.results.conditions import spread
from owtsweep.results.status import OK, UNABLE
from owtsweep.statistics.inference import percentile_interval, resample_means
from owtsweep.streams import encode_value

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
    run = owtsweep.run([
        "study=tower", f"sensors={sensors}", f"sea={sea}", f"tuning={TUNING}",
        f"schemes=[{cut},{whole}]", "grid.noise=[1]", f"grid.soil_factor={FACTORS}",
        "grid.replicates=10", *overrides,
    ])  # fmt: skip
    rows = spread(run.cases(), {"soil_factor": FACTORS})
    summary = run.summary()
    lines = []
    told = {"sensors": sensors, "sea": sea, "tuning": TUNING, "cut": cut, "whole": whole}
    unable = rows[rows.status == UNABLE].drop_duplicates("scheme")
    if len(unable):
        return pd.DataFrame([told | {"better_above": f"none: {unable.reason.iloc[0]}"}])
    for criterion in CRITERIA:
        found = find_crossings(rows, (whole, cut), criterion)
        means = summary[summary.measure == criterion].pivot_table(
            "mean", "scheme", "soil_factor", aggfunc="first"
        )
        errors = {"error_cut": means.loc[cut, 1.0], "error_whole": means.loc[whole, 1.0]}
        told |= {"criterion": criterion} | errors
        if found.empty:
            best = means[1.0].idxmin()
            lines.append(pd.DataFrame([told | {"better_above": f"none: {best} is better at all"}]))
        else:
            lines.append(found.drop(columns="noise").assign(**told))
    return pd.concat(lines)


def find_crossings(rows: pd.DataFrame, schemes: tuple[str, str], measure: str) -> pd.DataFrame:
    """Find the soil factors at which two schemes have equal means, at each noise.

    Parameters
    ----------
    rows
        The rows of a run's cases, with a value of every condition.
    schemes
        Names of the two schemes.
    measure
        Name of the measure to compare (the smaller, the better).

    Returns
    -------
    DataFrame
        One row per crossing, sorted by noise and factor: noise, then `COLUMNS`.
        `ci_low` and `ci_high` are the ends of the 95 % confidence interval; they are NaN with a
        single replicate. Where resamples have no such crossing within the values that were run,
        they are infinite (`ci_low`: 0). `better_above` is the scheme that is better above the
        crossing. `n` is the number of replicates that both schemes finished at all values. Without
        a crossing there is no row: one scheme is better at all values.
    """
    chosen = rows[(rows["status"] == OK) & (rows["measure"] == measure)]
    wide = chosen.pivot_table(
        "value", ["noise", "replicate"], ["scheme", "soil_factor"], observed=True, sort=True
    )
    difference = (wide[schemes[0]] - wide[schemes[1]]).dropna()
    places = np.log(np.array(difference.columns, dtype=float))
    lines = []
    for noise, part in difference.groupby(level="noise", sort=True):
        values = part.to_numpy()
        resampled = resample_means(values, [encode_value(noise)])
        for place, rising in _cross(places, values.mean(axis=0)):
            ends = _interval(places, resampled, place, rising)
            found = [float(np.exp(value)) for value in (place, *ends)]
            # the first scheme's error minus the second's rises: above, the second is better
            lines.append((noise, *found, schemes[1] if rising else schemes[0], len(values)))
    return pd.DataFrame(lines, columns=["noise", *COLUMNS])


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


def main() -> None:
    """Run all four sweeps, and write and print the table."""
    folder, _, overrides = read_words("results/tower_crossover")
    parts = [cross(sensors, sea, overrides) for sensors in SENSORS for sea in PAIRS]
    columns = [
        "sensors", "sea", "tuning", "criterion", "cut", "whole", "error_cut", "error_whole",
        *COLUMNS,
    ]  # fmt: skip
    table = pd.concat(parts, ignore_index=True)[columns]
    print(table.to_string(index=False))
    write(folder, {"crossover": table})


if __name__ == "__main__":
    main()
