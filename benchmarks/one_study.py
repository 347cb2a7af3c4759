"""One study in this process, without figures; prints one line of JSON.

    python -m benchmarks.one_study '["grid.replicates=2"]' True

The second argument says whether a study of one record goes before, so that gains and kernels are
there when the clock starts.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time

from owtsweep.config import compose
from owtsweep.studies import get_study
from owtsweep.sweep.run import sweep


def run(overrides: list[str], warm: bool) -> dict[str, float]:
    """Seconds of sweep and aggregation (wall), of both without planning and set-up (compute), peak
    memory and the bytes of all shards."""
    with tempfile.TemporaryDirectory() as results:
        if warm:
            _sweep([*overrides, "grid.replicates=1", "grid.natural_period=[4.0]"], results, "warm")
        began = time.perf_counter()
        outcome = _sweep(overrides, results, "timed")
        wall = time.perf_counter() - began
        shards = (outcome.run.folder / "cases").glob("*.parquet")
        return {
            "wall": wall,
            "compute": outcome.seconds,
            "peak": 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
            "bytes": float(sum(path.stat().st_size for path in shards)),
            "cases": float(outcome.computed),
        }


def _sweep(overrides: list[str], results: str, name: str):  # type: ignore[no-untyped-def]
    config = compose([*overrides, f"results={results}", f"name={name}"])
    return sweep(get_study(config.study), config)


if __name__ == "__main__":
    print(json.dumps(run(json.loads(sys.argv[1]), sys.argv[2] == "True")))
