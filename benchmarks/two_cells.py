"""Run a study of two cells in this process, without figures, and print its time as JSON.

This is what a first look at the program costs.

python -m benchmarks.two_cells [again]
"""

from __future__ import annotations

import json
import sys
import tempfile

from benchmarks import STUDY
from benchmarks.timing import timed


def two_cells(*, again: bool) -> dict[str, float]:
    """Measure the seconds of a study of two cells, the first run in this process.

    Returns `first`, the seconds by the clock; `cpu`, the core-seconds; and `again`, the seconds of
    a second run (0 if `again` is false).
    """
    with tempfile.TemporaryDirectory() as results:

        def study(name: str) -> None:
            import owtsweep

            owtsweep.run(
                [
                    *STUDY,
                    f"results={results}",
                    f"name={name}",
                    "grid.natural_period=[4.0]",
                    "grid.amplitude=[0.1,1.0]",
                    "grid.replicates=1",
                ]
            )

        first = timed(lambda: study("first"))[1]
        return {
            "first": first.wall,
            "cpu": first.cpu,
            "again": timed(lambda: study("again"))[1].wall if again else 0.0,
        }


if __name__ == "__main__":
    print(json.dumps(two_cells(again=len(sys.argv) > 1)))
