"""Compile every kernel that the tests use, into the cache that their processes share.

`make test` runs this beside the linters: workers of pytest that start on an empty cache would all
compile everything.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import owtsweep
from owtsweep.io import cache
from owtsweep.studies import get_study

#: Kernels are compiled anew for each number of series that run side by side.
HUB = (
    ("grid.replicates=1",),
    ("grid.replicates=2",),
    ("grid.replicates=8", "schemes=[HME1]"),
    ("grid.replicates=1", "evaluation=direct"),
    ("grid.replicates=1", "engine=expected"),
    ("grid.replicates=1", "schemes=[SKF,SKFA,SWITCH]"),
    ("schemes=[SKF]", "engine=expected", "measures.settling_time=5", "measures.window=settled"),
)
FLOATER = ("study=floater", "grid.delay=[2]", "grid.bias=[0.1]", "grid.replicates=1")
FLOATER += ("record.duration=60", "record.settling=20", "compute=single")
LARGE = "schemes=[ERROR_STATE,PASSIVE_OBSERVER,LOWPASS]"
#: One cell of each study, or two, with the schemes that have kernels.
RUNS = (
    *(("grid=small", "record.duration=50", *words) for words in HUB),
    (*FLOATER, f"schemes=[{','.join(get_study('floater').schemes())}]"),
    (*FLOATER, LARGE, "grid.roll=[20]", "sensors.frame=body"),
    ("study=blade", "grid.sigma=[0.006]", "grid.outage=[10]", "experiment=quick", "compute=single",
     "grid.replicates=1", f"schemes=[{','.join(get_study('blade').schemes())}]"),
    ("study=tower", "schemes=[AKF]", "grid.replicates=1", "record.duration=40",
     "record.settling=10", "compute=single"),
)  # fmt: skip


if __name__ == "__main__":
    owtsweep.online("HME2", []).update(np.zeros(2), np.zeros(2))
    with tempfile.TemporaryDirectory() as results:
        cache.folder = lambda: Path(results) / "cache"  # what is kept would spare a compilation
        for number, words in enumerate(RUNS):
            owtsweep.run([*words, f"results={results}", f"name={number}"])
