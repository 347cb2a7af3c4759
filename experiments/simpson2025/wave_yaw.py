"""Draw the damage at the ground over the direction of the waves, with and without a wave input.

    python -m experiments.simpson2025.wave_yaw [FOLDER] [RECORDS]

FOLDER (default: results/tower_wave_yaw) gets wave_yaw.csv and wave_yaw.png. RECORDS is 3 by default
(about two minutes on two cores).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pandas as pd
from joblib import delayed
from matplotlib.figure import Figure

from experiments.command import compute, read_words, write
from experiments.simpson2025.scenarios import NOISE, Scenario, run_scenarios
from experiments.simpson2025.scores import damages_of
from owtsweep.figures import style
from owtsweep.io.terminal import show_steps
from owtsweep.studies.base.contest import describe_origin
from owtsweep.studies.tower.contest import CONTEST

#: Angle between waves and wind, degrees.
YAWS = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
#: Input vectors of Simpson et al. (2025), section 5.4 -> scheme.
INPUTS = {"p_1: no wave input": "AKF", "p_2: triangular wave input": "AKF_WAVE"}
COLOURS = {"p_1: no wave input": "#D55E00", "p_2: triangular wave input": "#0072B2"}


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run both input vectors at all angles on records with these numbers, side by side.

    Returns
    -------
    pandas.DataFrame
        Columns yaw (degrees), inputs, direction, replicate, ratio: estimated over true damage at
        the ground, S-N curve as printed.
    """
    jobs = {
        f"yaw {yaw:g}, record {replicate}": delayed(_compare)(yaw, replicate, overrides)
        for yaw in YAWS
        for replicate in replicates
    }
    return pd.DataFrame([row for rows in compute(jobs) for row in rows])


def draw_yaws(table: pd.DataFrame, note: str) -> Figure:
    """Draw a table of `collect`: the mean over the records, and a dot for each record."""
    figure = style.new_figure(9.0, 3.8)
    for axes, direction in zip(figure.subplots(1, 2, sharey=True), ("fa", "ss"), strict=True):
        axes.axhspan(0.75, 1.25, color="0.92", zorder=0)
        axes.axhline(1.0, color="black", linewidth=1.0)
        for words, colour in COLOURS.items():
            chosen = table[(table["inputs"] == words) & (table["direction"] == direction)]
            axes.plot(chosen["yaw"], chosen["ratio"], ".", color=colour, alpha=0.5)
            axes.plot(chosen.groupby("yaw")["ratio"].mean(), color=colour, label=words)
        axes.set_title({"fa": "fore-aft", "ss": "side-side"}[direction], fontsize=10)
        axes.set_xlabel("waves against the wind (deg)")
        axes.set_xticks(YAWS)
    figure.axes[0].set_ylabel("damage at the ground, estimated / true")
    figure.axes[0].legend(frameon=False)
    style.footnote(figure, note)
    return figure


def _compare(yaw: float, replicate: int, overrides: Sequence[str]) -> list[dict[str, object]]:
    """Return the rows of one angle and record."""
    scenarios = {Scenario(sea="waves", scheme=scheme): words for words, scheme in INPUTS.items()}
    rows: list[dict[str, object]] = []
    for scenario, outcomes in run_scenarios(scenarios, replicate, [*overrides, f"waves.yaw={yaw}"]):
        for direction, outcome in outcomes.items():
            true, estimated = damages_of(outcome)
            rows.append({
                "yaw": yaw, "inputs": scenarios[scenario], "direction": direction,
                "replicate": replicate, "ratio": float(estimated[0] / true[0]),
            })  # fmt: skip
    return rows


if __name__ == "__main__":
    folder, records, _ = read_words("results/tower_wave_yaw", 3)
    with show_steps():
        table = collect(range(records))
    config = Scenario(sea="waves").compose([f"grid.replicates={records}"])
    note = (
        f"{describe_origin(CONTEST, config)}, {NOISE:g} % noise; yaw as on the axis. S-N curve as "
        "printed. Lines: means; dots: records; grey: within 25 %. Across the waves there is little "
        "to estimate: side-side at 0 deg, wind alone moves the structure."
    )
    write(folder, {"wave_yaw": table}, {"wave_yaw": partial(draw_yaws, table, note)})
