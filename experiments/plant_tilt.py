"""Find the single tilt by which HME1 follows a structure under waves best, and what then remains.

    python -m experiments.plant_tilt [FOLDER] [key=value ...]

An IMU on a structure leans by the slope of each mode, in resonance and in its quasi-static answer
to the waves; a filter knows one tilt, p'' = f + g tilt p + b. FOLDER (default: results/plant) gets
plant_tilt.csv: the settled position MSE (m^2, x + y) of HME1 with tuning=matched, for each sea
state and each case:

- level: the IMU stays level, so there is no tilt to know;
- one slope: the IMU leans by the slope of the first mode in all motion, and HME1 knows it;
- auto: the IMU leans as the structure does, HME1 believes in the slope of the first mode;
- unknown: the same IMU, HME1 takes it for level;
- best: the same IMU, HME1 believes in the tilt with the least MSE;
- best for motion: the same IMU, HME1 believes in the tilt with the least error from motion.

`motion` is the part of the MSE without any noise, `noise` that without any motion; their small rest
is the product of both errors. All cases of a sea state have the same waves and the same noise. The
overrides are those of `sweep motion=plant`.
"""

from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from experiments.command import read_words, show, write
from owtsweep.config import changed
from owtsweep.studies import compose
from owtsweep.studies.hub.batch import sum_errors
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import Records, make_records_at

#: Sea states, Hs in m and Tp in s; none of them breaks.
SEAS = ((1.0, 4.0), (2.0, 6.0), (2.0, 8.0), (5.0, 8.0), (3.0, 10.0))
#: Tilts between which the best is searched, and how closely, rad/m.
TILTS, CLOSE = (-0.03, 0.04), 1e-5


def make_records(words: list[str], hs: float, tp: float) -> Records:
    """Return the records of one sea state, Hs in m and Tp in s, under some overrides."""
    config: Any = compose(
        ["motion=plant", f"motion.hs=[{hs}]", f"motion.tp=[{tp}]", "grid.replicates=20", *words]
    )
    angles = config.motion.friction_angle
    sea = {"hs": hs, "tp": tp, "blades": config.motion.blades[0]}
    sea["friction_angle"] = angles[0] if angles else "layers"
    return make_records_at(config, sea, range(config.grid.replicates))


def run_hme1(records: Records, tilt: float) -> dict[str, float]:
    """Return the settled position MSE (m^2) of HME1 that believes in a tilt (rad/m), in parts."""
    config = records.config
    config = changed(config, hme1=changed(config.hme1, tilt=tilt))
    settled = round(config.measures.settling_time / records.sensors.step)
    chain = resolve("HME1").kernel(Known(records.sensors, config), records.steps)
    (sums,) = sum_errors([chain], records, settled)
    motion, cross, noise = sums.products[1, :2].sum(axis=0).mean(axis=1) / sums.steps[1]
    mse = float(motion + 2.0 * cross + noise)
    return {"tilt": tilt, "mse": mse, "motion": float(motion), "noise": float(noise)}


def find_best(records: Records, part: str) -> float:
    """Return the tilt (rad/m) that HME1 should believe in for the least `part` of its MSE."""
    found = minimize_scalar(
        lambda tilt: run_hme1(records, tilt)[part],
        bounds=TILTS,
        method="bounded",
        options={"xatol": CLOSE},
    )
    return float(found.x)


def compare_tilts(words: list[str], hs: float, tp: float) -> pd.DataFrame:
    """Return the rows of the table for one sea state."""
    leaning = make_records(words, hs, tp)
    first = leaning.config.hme1.tilt
    (level, one_slope) = (
        make_records([*words, f"sensors.imu.tilt={tilt}"], hs, tp) for tilt in (0.0, first)
    )
    rms = np.mean([motion.position.std() for motion in leaning.motion])
    cases = {
        "level": (level, 0.0),
        "one slope": (one_slope, first),
        "auto": (leaning, first),
        "unknown": (leaning, 0.0),
        "best": (leaning, find_best(leaning, "mse")),
        "best for motion": (leaning, find_best(leaning, "motion")),
    }
    where = {"hs": hs, "tp": tp, "rms": rms}
    return pd.DataFrame(
        [{**where, "case": name, **run_hme1(*case)} for name, case in cases.items()]
    )


if __name__ == "__main__":
    folder, _, overrides = read_words("results/plant")
    table = pd.concat([compare_tilts(overrides, *sea) for sea in SEAS])
    write(folder, {"plant_tilt": table})
    show(table, 4)
