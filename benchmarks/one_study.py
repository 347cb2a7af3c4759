"""Run one study in this process, without figures, and print time and memory as a line of JSON.

    python -m benchmarks.one_study '["grid.replicates=2"]'

The process has computed no gains and loaded no kernels before.
"""

from __future__ import annotations

import json
import sys
import tempfile

from benchmarks import STUDY
from benchmarks.scale import peak_megabytes
from benchmarks.timing import timed
from owtsweep.process import keep_freed_memory
from owtsweep.studies import compose, get_study
from owtsweep.sweep.run import sweep


def run(overrides: list[str]) -> dict[str, float]:
    """Run a study: planning, computing, writing and tables.

    Returns `wall`, the seconds of the run; `peak`, the peak memory of the process in 10^6 bytes;
    `bytes`, the size of all shards; and `cases`, the number of cases computed.
    """
    with tempfile.TemporaryDirectory() as results:
        config = compose([*STUDY, *overrides, f"results={results}"])
        outcome, time = timed(lambda: sweep(get_study(config.study), config))
        shards = (outcome.run.folder / "cases").glob("*.parquet")
        return {
            "wall": time.wall,
            "peak": float(peak_megabytes()),
            "bytes": float(sum(path.stat().st_size for path in shards)),
            "cases": float(outcome.computed),
        }


if __name__ == "__main__":
    keep_freed_memory()  # as the command does
    print(json.dumps(run(json.loads(sys.argv[1]))))
