"""Judge the readings that experiment=rivals found, on records that the search did not see.

    python -m experiments.ren2019.judge_rivals RUN [RECORDS] [FILE]

RUN is the folder of a run of experiment=rivals. The best trial of each search is judged on RECORDS
records per natural period (default: 100) with seed 2019; the search had another seed. FILE
(default: judged.csv) gets a table with one row per search; intervals of boundaries hold 95 % of
1000 bootstrap samples of the records.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import cpu_count

import owtsweep
from owtsweep.config import with_values
from owtsweep.io.tables import write_table
from owtsweep.studies import compose
from owtsweep.studies.hub.batch import sum_errors
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.listed import resolve
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.readings import score as scoring
from owtsweep.studies.readings.searches import take_fixed_values

SEED = 2019
BOOTSTRAPS = 1000


def run_schemes(config, schemes, count):
    """Return scheme -> natural period (s) -> products of each record, shape (4, 3, records)."""
    with ThreadPoolExecutor(cpu_count()) as pool:  # the kernels release the GIL
        each = list(pool.map(partial(run_period, config, schemes, count), scoring.PERIODS))
    return {
        scheme: dict(zip(scoring.PERIODS, products, strict=True))
        for scheme, products in zip(schemes, zip(*each, strict=True), strict=True)
    }


def run_period(config, schemes, count, period):
    """Return the products of each scheme at one natural period (s), shape (4, 3, records) each."""
    records = make_records(config, period, range(count))
    chains = [
        resolve(name).kernel(Known(records.sensors, config), records.steps) for name in schemes
    ]
    sums = sum_errors(chains, records, 0, consistency=False)
    return [one.products[:, :4].sum(axis=0) / records.steps for one in sums]


def average(results):
    """Return the results of `run_schemes` with means over the records, shape (4, 3)."""
    return {
        name: {period: products.mean(axis=2) for period, products in periods.items()}
        for name, periods in results.items()
    }


def judge(results):
    """Return the numbers by which a reading is judged, as a dict: one row of the table."""
    products = average(results)
    score, details = scoring.score(products)
    table = scoring.compare(products)
    logs = table.log2.abs()
    row = {
        "score": score,
        "median_log2": details["median_log2"],
        "p80_log2": details["p80_log2"],
        "missed_by_2": int((logs > 1.0).sum()),
        "numbers": len(logs),
    }
    for number, part in logs.groupby(table.table):
        row[f"table_{number}"] = part.mean()
    if "HME1" in products:
        row["winners"] = details["winners"]
        generator = np.random.default_rng(SEED)
        for period in (4.0, 6.0, 8.0):
            pair = [results[name][period] for name in ("HME2", "HME1")]
            count = pair[0].shape[2]
            samples = [
                scoring.boundary(*(one[..., chosen].mean(axis=2) for one in pair))
                for chosen in generator.integers(0, count, (BOOTSTRAPS, count))
            ]
            low, high = np.nanquantile(samples, [0.025, 0.975])
            row[f"boundary_{period:g}s"] = details[f"boundary_{period:g}s"]
            row[f"interval_{period:g}s"] = f"[{low:.3g}, {high:.3g}]"
    return row


def main(run, count, file):
    """Judge the best trial of each search in the run's table `best`; write and print the table."""
    best = run.table("best")
    base = with_values(compose(["experiment=rivals"]), {"seed": SEED})
    calibration = base.calibration
    rows = []
    for (target, truth), trials in best.groupby(["target", "truth"], sort=True):
        trial = trials.sort_values(["score", "trial"]).iloc[0]
        about = calibration.targets[target]
        found = {
            key: int(trial[name]) if bounds[2] == "int" else float(trial[name])
            for name, bounds in about["parameters"].items()
            for key in name.split("+")
        }
        fixed = take_fixed_values(about, base.tuning_name)
        config = with_values(base, {**fixed, **calibration.truths[truth], **found})
        row = {"target": target, "truth": truth, "trial": trial.trial, "searched": trial.score}
        row |= judge(run_schemes(config, list(about["schemes"]), count)) | found
        rows.append(row)
        print({key: value for key, value in row.items() if key not in found}, flush=True)
    write_table(file.parent, file.stem, pd.DataFrame(rows))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python -m experiments.ren2019.judge_rivals RUN [RECORDS] [FILE]")
    main(
        owtsweep.load(sys.argv[1]),
        int(sys.argv[2]) if len(sys.argv) > 2 else 100,
        Path(sys.argv[3] if len(sys.argv) > 3 else "judged.csv"),
    )
