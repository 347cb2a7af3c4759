"""Compile every kernel that the tests use, into the cache that their processes share.

`make test` runs this beside the linters: workers of pytest that start on an empty cache would all
compile everything.
"""

from __future__ import annotations

import tempfile

import numpy as np

import owtsweep
from owtsweep.studies import get_study

TINY = ("grid=small", "record.duration=50")
#: Kernels are compiled anew for each number of series that run side by side.
RUNS = (
    ("grid.replicates=1",),
    ("grid.replicates=2", "name=two"),
    ("grid.replicates=1", "evaluation=direct", "name=direct"),
    ("grid.replicates=1", "engine=expected", "name=expected"),
)
#: One cell of the studies whose schemes have kernels of their own.
CELLS = {
    "floater": ("grid.delay=[2]", "grid.bias=[0.1]", "record.duration=60", "record.settling=20"),
    "blade": ("grid.sigma=[0.006]", "grid.outage=[10]", "experiment=quick"),
}


def online() -> None:
    owtsweep.online("HME2", []).update(np.zeros(2), np.zeros(2))


def studies() -> None:
    with tempfile.TemporaryDirectory() as results:
        for words in RUNS:
            owtsweep.run([*TINY, *words, f"results={results}"])


def declared() -> None:
    with tempfile.TemporaryDirectory() as results:
        for study, cell in CELLS.items():
            schemes = f"schemes=[{','.join(get_study(study).schemes())}]"
            words = (*cell, schemes, "grid.replicates=1", "compute=single", f"results={results}")
            owtsweep.run([f"study={study}", *words])


if __name__ == "__main__":
    online()
    studies()
    declared()
