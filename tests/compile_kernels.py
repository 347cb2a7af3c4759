"""Compile every kernel that the tests use, into the cache that their processes share.

`make test` runs this beside the linters, once per part (`online`, `studies`): two workers of pytest
that start on an empty cache would both compile everything.
"""

from __future__ import annotations

import sys
import tempfile

import numpy as np

import owtsweep
from owtsweep.studies.hub.compiling import compile_kernels

TINY = ("grid=small", "grid.replicates=1", "record.duration=50")


def online() -> None:
    compile_kernels("gains", "recorded", vectors=True)
    owtsweep.online("HME2", []).update(np.zeros(2), np.zeros(2))


def studies() -> None:
    with tempfile.TemporaryDirectory() as results:
        for extra in ((), ("evaluation=direct", "name=direct"), ("engine=expected", "name=exp")):
            owtsweep.run([*TINY, f"results={results}", *extra])


if __name__ == "__main__":
    {"online": online, "studies": studies}[sys.argv[1]]()
