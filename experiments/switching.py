"""What SWITCH gains in a sea that grows and falls, and what it costs in seas that do not.

    python -m experiments.switching [FOLDER] [NAME=VALUE ...]

Sweeps SWITCH and its two schemes, MKF below the boundary and HME1 above (below results/, names
switching_...), 4 records of 2000 s per cell, tuning=matched, sensors=strong_bias, seed 7, errors
from 120 s on. Writes into FOLDER (default: results/better):

- switching.csv: run, natural_period (s), amplitude (m), scheme, measure, mse (m^2 or (m/s)^2),
  ci_low, ci_high (95 %, t over the records), records. The scheme "HME1 - SWITCH" is the difference
  of the two, in pairs of records;
- switching_boundary.csv: natural_period (s), boundary (m), as computed without records;
- switching.png and switching.svg.

Further arguments are overrides of all runs, e.g. results=elsewhere.
"""

from functools import partial

import pandas as pd

import owtsweep
from experiments.command import read_words, write
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.statistics.contrasts import gap
from owtsweep.studies import compose
from owtsweep.studies.hub.describe import make_cube
from owtsweep.studies.hub.switching.boundary import compute_boundary

BASE = [
    "baselines=[]", "sensors=strong_bias", "seed=7", "record.duration=2000",
    "measures.settling_time=120", "measures.window=settled", "grid.replicates=4",
    "tuning=matched", "schemes=[HME1,MKF,SWITCH]", "switch.below=MKF",
]  # fmt: skip
#: Run -> its overrides.
RUNS = {
    "growing": [
        "grid.natural_period=[4]", "grid.amplitude=[1]",
        "motion.envelope=[[0,0.1],[1000,10],[2000,0.1]]",
    ],
    "steady": ["grid.natural_period=[3.0,4.0,6.0,8.0]", "grid.amplitude=[0.1,0.5]"],
}  # fmt: skip
PERIODS = (3.0, 4.0, 6.0, 8.0)
KEYS = ["run", "natural_period", "amplitude", "scheme", "measure"]


def average(values):
    """Return mean, both ends of its 95 % interval, and number of values."""
    found = gap(values)
    return float(found.value), float(found.low), float(found.high), len(values)


def run_one(name, overrides):
    """Run one sweep; return rows of switching.csv."""
    run = owtsweep.run([*BASE, *RUNS[name], f"name=switching_{name}", *overrides])
    cases = run.cases()
    table = make_cube(run.config, cases[cases["window"] == "settled"]).to_table()
    table = table[table["measure"].isin(["position", "velocity"])]
    cells = ["natural_period", "amplitude", "measure"]
    rows = []
    for cell, part in table.groupby(cells):
        period, amplitude, measure = cell
        wide = part.pivot(index="replicate", columns="scheme", values="value")
        wide["HME1 - SWITCH"] = wide["HME1"] - wide["SWITCH"]
        for scheme, values in wide.items():
            key = (name, period, amplitude, scheme, measure)
            rows.append((*key, *average(values.to_numpy())))
    return rows


def tabulate_boundaries():
    """Return the boundaries that SWITCH computes for itself, without records."""
    config = compose(BASE)
    edge = compute_boundary(config, "MKF", "HME1", config.switch.crest)
    rows = [(period, edge.amplitude(period)) for period in PERIODS]
    return pd.DataFrame(rows, columns=["natural_period", "boundary"])


def draw(table):
    """Draw the errors in the sea that grows and falls, and what SWITCH costs in steady seas."""
    figure = style.new_figure(10.0, 4.4)
    left, right = figure.subplots(1, 2)
    position = table[table["measure"] == "position"]
    schemes = ["MKF", "HME1", "SWITCH"]
    part = position[position["run"] == "growing"].set_index("scheme")
    for place, name in enumerate(schemes):
        row, look = part.loc[name], style_of(name, schemes)
        left.plot(place, row["mse"], look.marker, color=look.color, markersize=7)
        left.vlines(place, row["ci_low"], row["ci_high"], color=look.color)
    left.set_xticks(range(len(schemes)), schemes)
    left.set(xlim=(-0.5, len(schemes) - 0.5), yscale="log")
    left.set_ylabel("MSE of the position, x + y (m²)")
    left.set_title("4 s, growing from .1 to 10 m and back", loc="left")
    ratio = find_ratio(position[position["run"] == "steady"])
    for period, lines in ratio.groupby(level="natural_period"):
        at = lines.droplevel("natural_period")
        right.plot(at.index, at, "o-", markersize=4, label=f"{period:g} s")
    right.set(
        xscale="log", xlabel="motion amplitude (m)", ylabel="SWITCH over the better of its two"
    )
    right.set_xticks([0.1, 0.5], ["0.1", "0.5"])
    right.minorticks_off()
    right.set_title("Seas that neither grow nor fall", loc="left")
    right.legend(fontsize=8)
    figure.suptitle(
        "SWITCH: MKF below the boundary, HME1 above; tuning matched\n"
        "Settled part of 4 records of 2000 s, sensors strong_bias, seed 7; 95 % intervals",
        x=0.01, ha="left", fontsize=10,
    )  # fmt: skip
    return figure


def find_ratio(rows):
    """Return SWITCH's error over the lesser of its two schemes', by period and amplitude."""
    wide = rows.pivot(index=["natural_period", "amplitude"], columns="scheme", values="mse")
    others = wide.drop(columns=["SWITCH", "HME1 - SWITCH"])
    return wide["SWITCH"] / others.min(axis=1)


def main():
    """Run all sweeps; write both tables and the figure."""
    folder, _, overrides = read_words("results/better")
    rows = [row for name in RUNS for row in run_one(name, overrides)]
    table = pd.DataFrame(rows, columns=[*KEYS, "mse", "ci_low", "ci_high", "records"])
    tables = {"switching": table, "switching_boundary": tabulate_boundaries()}
    write(folder, tables, {"switching": partial(draw, table)})


if __name__ == "__main__":
    main()
