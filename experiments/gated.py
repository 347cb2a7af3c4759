"""How near SKFA comes to the best of schemes with a gate and baselines, in worlds of bad fixes.

    python -m experiments.gated [FOLDER] [RECORDS] [NAME=VALUE ...]

A world is the truth of experiment=better (tuning=matched, sensors=strong_bias) with one thing
changed (gated.toml), in all its 60 cells, in records of 600 s, errors from 120 s on. No scheme is
told of the change. EKF, MKF and HME1 refuse outlying fixes (`fix_rule=gate`; HME2 has no gate),
SKFA does by default; NONE, HOLD and DELTA are the baselines. SKFA's mean square error of the
position is divided by that of each rival, over the same records.

After each of `LOOKS` a cell is done if SKFA's error is at most `NEAR` times that of every rival, by
upper limits of the ratios; the others get more records, at last RECORDS (default 100). The limits
are one-sided, of 99 %, so that all looks of a cell together are wrong in 3 % at most.

Writes into FOLDER (default: results/gated) gated.csv: world, natural_period (s), amplitude (m),
records, mse (of SKFA, m^2), rival (the one with the least error), ratio (SKFA's mean square error
over that rival's), high (the largest upper limit of all rivals) and nees (of SKFA, per degree of
freedom). Further arguments are overrides of all runs.
"""

import numpy as np
import pandas as pd

import owtsweep
from experiments.command import read_data, read_words, show, write
from owtsweep.statistics.deciding import find_quantile
from owtsweep.statistics.inference import fieller

WORLDS = read_data(__file__)
LOOKS, NEAR, LEVEL = (8, 32), 1.05, 0.01
SKFA = "SKFA"
#: States that NEES counts: position and velocity, x and y.
STATES = 4.0
COMMON = [
    "experiment=better", "schemes=[EKF,MKF,HME1,SKFA]", "baselines=[NONE,HOLD,DELTA]",
    "measures.efficiency=false", "record.duration=600", "ekf.fix_rule=gate", "mkf.fix_rule=gate",
    "hme1.fix_rule=gate",
]  # fmt: skip
CELL = ["natural_period", "amplitude"]


def measure(words):
    """Run a sweep; return squared position errors and SKFA's NEES, a row per cell and record."""
    rows = owtsweep.run([*COMMON, *words]).cases()
    settled = rows[rows["window"] == "settled"]
    table = settled.pivot_table(
        index=[*CELL, "replicate"], columns=["measure", "scheme"], values="value"
    )
    return table["position"].assign(nees=table["nees", SKFA] / STATES)


def compare(errors):
    """Return what gated.csv says of the records of a cell, one column per scheme."""
    own, means = errors[SKFA], errors.drop(columns=[SKFA, "nees"]).mean()
    quantile = -find_quantile(LEVEL, len(errors) - 1)
    highs = [fieller(own, errors[name], quantile)[1] for name in means.index]
    return {
        "records": len(errors), "mse": own.mean(), "rival": means.idxmin(),
        "ratio": own.mean() / means.min(), "high": np.max(highs), "nees": errors["nees"].mean(),
    }  # fmt: skip


def run_world(name, most, overrides):
    """Look at all cells of a world until each is done or has `most` records; return its table."""
    found, words = {}, []
    for records in [*(look for look in LOOKS if look < most), most]:
        errors = measure([*WORLDS[name], *overrides, *words, f"grid.replicates={records}"])
        found |= {cell: compare(part) for cell, part in errors.groupby(level=CELL)}
        doubtful = [cell for cell, each in found.items() if not each["high"] <= NEAR]
        print(f"{name}: {len(doubtful)} of {len(found)} cells left at {records}", flush=True)
        if not doubtful:
            break
        # all periods and amplitudes of these cells, so some that are done get more records too
        values = zip(CELL, zip(*doubtful, strict=True), strict=True)
        words = [f"grid.{axis}={sorted(set(some))}" for axis, some in values]
    rows = [{"world": name, **dict(zip(CELL, cell, strict=True)), **found[cell]} for cell in found]
    return pd.DataFrame(rows)


def count(table):
    """Return what the page says of each world: in how many cells SKFA is near, and how far off."""
    return table.groupby("world", sort=False).agg(
        cells=("ratio", "size"), near=("ratio", lambda r: np.sum(r <= NEAR)),
        surely=("high", lambda h: np.sum(h <= NEAR)), largest=("ratio", "max"),
        highest=("high", "max"), nees=("nees", "mean"), records=("records", "sum"),
    ).reset_index()  # fmt: skip


def main():
    """Run all worlds; write the table and print the counts."""
    folder, records, overrides = read_words("results/gated", 100)
    table = pd.concat([run_world(name, records, overrides) for name in WORLDS], ignore_index=True)
    write(folder, {"gated": table})
    show(count(table))


if __name__ == "__main__":
    main()
