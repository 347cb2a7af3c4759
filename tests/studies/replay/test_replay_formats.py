"""Each format that can be read is replayed."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pandas as pd
import writers
from replay_tools import DIRECTION, motion

from owtsweep.studies.replay.running import configure, execute

QUICK = [
    "schemes=[HME1]", "replay.replicates=1", "measures.settling_time=5", "columns.position_x=px",
    "columns.position_y=py", "columns.time=Time",
]  # fmt: skip


def csv(folder, table):
    frame = pd.DataFrame({name: values for name, (_, values) in table.items()})
    frame.to_csv(folder / "a.csv.gz", index=False)
    return folder / "a.csv.gz"


def parquet(folder, table):
    frame = pd.DataFrame({name: values for name, (_, values) in table.items()})
    frame.to_parquet(folder / "a.parquet")
    return folder / "a.parquet"


def npz(folder, table):
    np.savez(folder / "a.npz", **{name: values for name, (_, values) in table.items()})
    return folder / "a.npz"


FORMATS = {
    "csv.gz": csv,
    "parquet": parquet,
    "npz": npz,
    "out": lambda folder, table: writers.fast_text(folder / "a.out", table),
    "outb": lambda folder, table: writers.fast_binary(folder / "a.outb", table, 2),
    "hawc2 ascii": lambda folder, table: writers.hawc2(folder, table, "ascii"),
    "gtsdf": lambda folder, table: writers.gtsdf(folder / "a.hdf5", table, packed=False),
}


def test_each_format_replays(tmp_path, monkeypatch):
    """The same motion in files of all formats, together in one run."""
    monkeypatch.chdir(tmp_path)
    time, d = motion(25.0)
    xy = np.outer(d, DIRECTION)
    table = {"Time": ("s", time), "px": ("m", xy[:, 0]), "py": ("m", xy[:, 1])}
    names = [name for name in FORMATS if name != "gtsdf" or find_spec("h5py")]
    files = [str(FORMATS[name](tmp_path, table)) for name in names]
    outcome = execute(configure(files, QUICK))
    assert not outcome.failed
    rows = outcome.run.table("errors").query("scheme == 'HME1' and window == 'settled'")
    errors = rows[rows["measure"] == "position"].set_index("file")["mean"]
    assert len(errors) == len(names)
    assert errors.between(1e-4, 1e-2).all()
    folders = sorted((outcome.run.folder / "records").iterdir())
    assert len(folders) == len(names)
    for folder in folders:
        estimates = pd.read_parquet(folder / "estimates.parquet")
        late = estimates[estimates.time > 5]
        assert np.std(late.x - np.interp(late.time, time, xy[:, 0])) < 0.1, folder
