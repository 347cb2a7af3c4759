"""Draw the map of figure 18 on the plant's seas beside that on the spectrum, for both tunings.

    python -m experiments.ren2019.plant_map [FOLDER] [RECORDS] [key=value ...]

FOLDER (default: results/plant) gets plant_map.csv and plant_map.png; RECORDS per cell is 20 by
default (under a minute of a core). In the plant's seas the motion is that of the structure ren2019
in waves of Hs 2 m, its time stretched until its first mode has the cell's natural period, with the
cell's amplitude.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import pandas as pd
from matplotlib.figure import Figure

import owtsweep
from experiments.command import read_words, write
from experiments.ren2019.two_maps import draw_map
from owtsweep.figures import style
from owtsweep.figures.margin import add_legend, list_shades
from owtsweep.results.boundary import find_boundary, subtract_schemes
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import scheme_names
from owtsweep.studies.hub.describe import describe_in_a_line
from owtsweep.studies.hub.worlds import BOUNDARY, CONDITIONS
from owtsweep.sweep.runs import Run

SEA = ("structure=ren2019", "motion.hs=[2]")
#: Motion -> overrides. Hs 2 m with Tp 8 s is the sea of figures 3 and 4, with 6 s of figures 9-14.
MOTIONS = {
    "spectrum": (),
    "Tp 8 s": (*SEA, "motion.tp=[8]"),
    "Tp 6 s": (*SEA, "motion.tp=[6]"),
    "Tp 8 s, leaning IMU": (*SEA, "motion.tp=[8]", "sensors.imu.tilt=0.0137"),
}
#: The motions that are drawn; all are in the table.
DRAWN = ("spectrum", "Tp 8 s")
#: Tuning -> its truth: that of the closest reading of the paper, or the default.
TUNINGS = {
    "paper": ("experiment=paper", "tuning=paper"),
    "matched": ("measures.window=full", "tuning=matched"),
}
CRITERION, WINDOW = "position", "full"
COLUMNS = (
    "natural_period", "amplitude", "best", "runner_up", "mse_best", "mse_runner_up",
    "distinguishable", "baseline_wins",
)  # fmt: skip


def tabulate(runs: Mapping[tuple[str, str], Run]) -> pd.DataFrame:
    """Return the cells of all maps.

    `runs` maps (motion, tuning) to a run. Columns: motion, tuning, those of `COLUMNS` (s, m, m^2),
    and boundary, the amplitude at which HME1 and HME2 are equally good at this period (m; NaN if
    one of them is better at every amplitude).
    """
    parts = []
    for (motion, tuning), run in runs.items():
        best = run.best_scheme()
        cells = best.loc[(best["criterion"] == CRITERION) & (best["window"] == WINDOW)]
        difference = subtract_schemes(run.cases(), CONDITIONS, BOUNDARY, CRITERION, WINDOW)
        boundary = find_boundary(difference, BOUNDARY)
        at = boundary.set_index("natural_period")["boundary"]
        cells = cells[list(COLUMNS)].assign(boundary=cells["natural_period"].map(at))
        cells.insert(0, "motion", motion)
        cells.insert(1, "tuning", tuning)
        parts.append(cells)
    return pd.concat(parts, ignore_index=True)


def draw(runs: Mapping[tuple[str, str], Run]) -> Figure:
    """Draw the maps of `DRAWN`, a column each, with both tunings below each other."""
    figure = style.new_figure(11.0, 10.5)
    notes: list[str] = []
    for line, tuning in zip(figure.subplots(2, len(DRAWN)), TUNINGS, strict=True):
        for axes, motion in zip(line, DRAWN, strict=True):
            run = runs[motion, tuning]
            notes += draw_map(axes, run, cast("HubConfig", run.config))
            title = "Eq. (1), as in figure 18" if motion == DRAWN[0] else f"plant, Hs 2 m, {motion}"
            axes.set_title(f"{title}; tuning: {tuning}", loc="left")
    configs = [cast("HubConfig", runs[DRAWN[0], tuning].config) for tuning in TUNINGS]
    names = scheme_names(configs[0])
    handles = list_shades(names, names)
    add_legend(figure, handles, columns=len(handles))
    told = [f"{describe_in_a_line(config)}." for config in configs]
    style.footnote(figure, " ".join(dict.fromkeys([*told, *notes])))
    return figure


if __name__ == "__main__":
    folder, records, words = read_words("results/plant", 20)
    runs = {}
    for motion, overrides in MOTIONS.items():
        for tuning, truth in TUNINGS.items():
            given = [*truth, f"grid.replicates={records}", *overrides, *words]
            runs[motion, tuning] = owtsweep.run(given)
    write(folder, {"plant_map": tabulate(runs)}, {"plant_map": lambda: draw(runs)})
