"""What SWITCH gains in a sea that grows and falls, and what it costs in seas that do not.

    python -m experiments.switching [FOLDER] [NAME=VALUE ...]

Sweeps SWITCH and its two schemes (below results/, names switching_...), 4 records of 2000 s per
cell, sensors=strong_bias, seed 7, errors from 120 s on. Writes into FOLDER (default:
results/better):

- switching.csv: run, tuning, natural_period (s), amplitude (m), scheme, measure, mse (m^2 or
  (m/s)^2), ci_low, ci_high (95 %, t over the records), records. The scheme "HME1 - SWITCH" is the
  difference of the two, in pairs of records;
- switching_boundary.csv: tuning, below, above, natural_period (s), boundary (m), as computed
  without records;
- switching.png and switching.svg.

Further arguments are overrides of all runs, e.g. results=elsewhere.
"""

from functools import partial

import pandas as pd

import owtsweep
from experiments.command import read_data, read_words, write
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.statistics.contrasts import gap
from owtsweep.studies import compose
from owtsweep.studies.hub.describe import make_cube
from owtsweep.studies.hub.switching.boundary import compute_boundary

BASE = [
    "baselines=[]", "sensors=strong_bias", "seed=7", "record.duration=2000",
    "measures.settling_time=120", "measures.window=settled", "grid.replicates=4",
]  # fmt: skip
#: Tuning -> its overrides, and run -> its tuning and overrides.
TUNINGS, RUNS = read_data(__file__).values()
#: Tuning -> the scheme below the boundary.
BELOW = {"paper": "HME2", "matched": "MKF"}
PERIODS = (3.0, 4.0, 6.0, 8.0)
KEYS = ["run", "tuning", "natural_period", "amplitude", "scheme", "measure"]


def average(values):
    """Return mean, both ends of its 95 % interval, and number of values."""
    found = gap(values)
    return float(found.value), float(found.low), float(found.high), len(values)


def run_one(name, overrides):
    """Run one sweep; return rows of switching.csv."""
    tuning, words = RUNS[name].values()
    run = owtsweep.run([*BASE, *TUNINGS[tuning], *words, f"name=switching_{name}", *overrides])
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
            key = (name, tuning, period, amplitude, scheme, measure)
            rows.append((*key, *average(values.to_numpy())))
    return rows


def tabulate_boundaries():
    """Return the boundaries that SWITCH computes for itself, without records."""
    rows = []
    for tuning, below in BELOW.items():
        config = compose([*BASE, *TUNINGS[tuning]])
        edge = compute_boundary(config, below, "HME1", config.switch.crest)
        rows += [(tuning, below, "HME1", period, edge.amplitude(period)) for period in PERIODS]
    columns = ["tuning", "below", "above", "natural_period", "boundary"]
    return pd.DataFrame(rows, columns=columns)


def draw(table):
    """Draw the errors in the sea that grows and falls, and what SWITCH costs in steady seas."""
    figure = style.new_figure(10.0, 4.4)
    left, right = figure.subplots(1, 2)
    position = table[table["measure"] == "position"]
    schemes = ["HME1", "HME2", "MKF", "SWITCH"]
    labels = []
    for run in ("growing", "growing_matched"):
        part = position[position["run"] == run].set_index("scheme")
        for name in [name for name in schemes if name in part.index]:
            row, look, place = part.loc[name], style_of(name, schemes), len(labels)
            left.plot(place, row["mse"], look.marker, color=look.color, markersize=7)
            left.vlines(place, row["ci_low"], row["ci_high"], color=look.color)
            labels.append(f"{name}\n{row['tuning']}")
    left.set_xticks(range(len(labels)), labels)
    left.set(xlim=(-0.5, len(labels) - 0.5), yscale="log")
    left.set_ylabel("MSE of the position, x + y (m²)")
    left.set_title("4 s, growing from .1 to 10 m and back", loc="left")
    for run, line in (("steady", "-"), ("steady_matched", "--")):
        ratio = find_ratio(position[position["run"] == run])
        tuning = RUNS[run]["tuning"]
        for number, (period, part) in enumerate(ratio.groupby(level="natural_period")):
            at = part.droplevel("natural_period")
            right.plot(
                at.index, at, f"o{line}", color=f"C{number}", markersize=4,
                label=f"{tuning}, {period:g} s",
            )  # fmt: skip
    right.set(
        xscale="log", xlabel="motion amplitude (m)", ylabel="SWITCH over the better of its two"
    )
    right.set_xticks([0.1, 0.5, 1.0, 3.0], ["0.1", "0.5", "1", "3"])
    right.minorticks_off()
    right.set_title("Seas that neither grow nor fall", loc="left")
    right.legend(fontsize=8)
    figure.suptitle(
        "SWITCH: HME2 (paper) or MKF (matched) below the boundary, HME1 above\n"
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
