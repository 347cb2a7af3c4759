"""Ask how well the soil must be known: where a filter on the whole turbine beats the cut structure.

    python -m experiments.tower.crossover [FOLDER] [override ...]

The tower study is swept over the soil factor at 1 % noise, with ten records, for two set-ups of
sensors (sparse and dry), with wind alone and with waves. FOLDER (default: results/tower_crossover)
gets crossover.csv: the factors at which both filters are equally good, with 95 % intervals, by the
error of the base moment and by damage. Between two crossings the filter on the whole turbine is
better. A row "none" says which filter is better at all factors, or why one is unable to work.
Overrides go to all four sweeps.
"""

import sys
from pathlib import Path

import pandas as pd

import owtsweep
from owtsweep.io.tables import write_table
from owtsweep.results.crossings import find_crossings
from owtsweep.results.status import UNABLE
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.measures import WINDOW
from owtsweep.studies.tower.tables import spread_soil

FACTORS = [0.5, 0.63, 0.8, 0.9, 0.95, 0.98, 1.0, 1.02, 1.05, 1.1, 1.25, 1.6, 2.0]
SENSORS = ("sparse_theta_a", "dry")
#: Sea -> filter on the cut structure, filter on the whole turbine.
PAIRS = {"calm": ("AKF", "AKF_WHOLE"), "waves": ("AKF_WAVE", "AKF_WHOLE_WAVE")}
CRITERIA = ("base_moment", "damage")
TUNING = "matched"


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
    rows = spread_soil(run.config, run.cases())
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
