"""Make the undamaged runs and records; every hostile test gets a copy of some of them."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pandas as pd
import writers
from scipy.io import savemat

from owtsweep.cli.program import main

TINY = (
    "experiment=study", "tuning=paper",
    "grid.natural_period=[4.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=2",
    "record.duration=30", "measures.settling_time=5", "compute.backend=threading",
    "schemes=[MKF,HME1]",
)  # fmt: skip
#: The names of the records, one for each file format.
RECORDS = ("r.csv", "r.csv.gz", "r.npz", "r.mat", "r.parquet", "r.outb", "r.out", "r.sel", "r.hdf5")


def make_runs(folder: Path) -> None:
    """Make a run in `folder`/a, and a multirun of two runs in `folder`/m."""
    assert main(["sweep", *TINY, f"results={folder}", "name=a"]) == 0
    assert main(["sweep", "-m", *TINY, f"results={folder}", "seed=1,2"]) == 0
    next(folder.glob("multirun-*")).rename(folder / "m")


def make_records(folder: Path) -> None:
    """Write one motion of 60 s, sampled at 10 Hz, into `folder` in every file format."""
    folder.mkdir()
    time = np.arange(600) / 10
    x, y = np.sin(1.5 * time), 0.5 * np.sin(1.5 * time)
    columns = {"time": time, "position_x": x, "position_y": y}
    frame = pd.DataFrame(columns)
    frame.to_csv(folder / "r.csv", index=False)
    (folder / "r.csv.gz").write_bytes(gzip.compress((folder / "r.csv").read_bytes()))
    np.savez(folder / "r.npz", **columns)
    savemat(folder / "r.mat", columns, do_compression=True)
    frame.to_parquet(folder / "r.parquet")
    table = {"Time": ("s", time), "TwHt1TPxi": ("m", x), "TwHt1TPyi": ("m", y)}
    writers.fast_binary(folder / "r.outb", table, kind=2)
    writers.fast_text(folder / "r.out", table)
    pair = writers.hawc2(folder, table, "BINARY")
    for path in (pair.with_suffix(".sel"), pair.with_suffix(".dat")):
        path.rename(folder / f"r{path.suffix}")
    writers.gtsdf(folder / "r.hdf5", table, packed=False)
