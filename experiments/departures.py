"""How SKFA fares where its assumptions do not hold: faults, red noise, tilt, the plant, new seeds.

    python -m experiments.departures [FOLDER] [RECORDS] [NAME=VALUE ...]

Every departure is the truth of experiment=better (tuning=matched, sensors=strong_bias) with one
thing changed, in RECORDS records (default 8) of 600 s, errors from 120 s on. HME1 refuses outlying
fixes by `fix_rule=gate`, SKFA by default. SKFA, like all others, is not told of the change.
`plant` has a structure under waves (motion=plant, records of 1000 s). `seed N` are RECORDS records
of 2000 s of other seeds than that of efficiency.csv, in all its cells.

Writes into FOLDER (default: results/better) departures.csv: departure, natural_period (s) and
amplitude (m) or hs (m) and tp (s), scheme, mse (of the position, m^2), nees (per degree of
freedom), efficiency (bound (b) over mse; with seeds alone). Further arguments are overrides of all
runs.
"""

import pandas as pd

import owtsweep
from experiments.command import read_data, read_words, write

#: States that NEES counts: position and velocity, x and y.
STATES = 4.0
SHORT = ["measures.efficiency=false", "record.duration=600", "hme1.fix_rule=gate"]
SCHEMES = ["schemes=[MKF,HME1,SKFA]", "baselines=[NONE]"]
#: Name -> what is changed.
DEPARTURES = read_data(__file__)
SEEDS = (1, 2)
COLUMNS = [
    "departure", "natural_period", "amplitude", "hs", "tp", "scheme", "mse", "nees", "efficiency",
]  # fmt: skip


def run(name, words):
    """Return the settled errors of one run, with the columns COLUMNS."""
    summary = owtsweep.run(words).summary()
    kept = summary[summary["window"] == "settled"]
    cell = [each for each in ("natural_period", "amplitude", "hs", "tp") if each in kept]
    place = [*cell, "scheme"]
    settled = {measure: part.set_index(place) for measure, part in kept.groupby("measure")}
    parts = {"mse": settled["position"]["mean"], "nees": settled["nees"]["mean"] / STATES}
    if "efficiency_b" in kept:
        parts["efficiency"] = settled["position"]["efficiency_b"]
    table = pd.concat(parts, axis=1).reset_index().assign(departure=name)
    print(f"{name}: {len(table)} rows", flush=True)
    return table.reindex(columns=COLUMNS)


def main():
    """Run all departures; write the table."""
    folder, records, overrides = read_words("results/better", 8)
    common = ["experiment=better", f"grid.replicates={records}"]
    runs = {name: [*SHORT, *SCHEMES, *words] for name, words in DEPARTURES.items()}
    for seed in SEEDS:
        runs[f"seed {seed}"] = [f"seed={seed}", "schemes=[HME1,SKF,SKFA]", "baselines=[]"]
    tables = [run(name, [*common, *words, *overrides]) for name, words in runs.items()]
    write(folder, {"departures": pd.concat(tables, ignore_index=True)})


if __name__ == "__main__":
    main()
