"""A study of two cells in this process, without figures: what a first look costs. Prints JSON.

python -m benchmarks.two_cells [again]
"""

from __future__ import annotations

import json
import sys
import tempfile

from benchmarks.timing import timed


def two_cells(*, again: bool) -> dict[str, float]:
    """Seconds of a study of two cells in an empty folder: the first of a process, and the next."""
    with tempfile.TemporaryDirectory() as results:

        def study(name: str) -> None:
            import owtsweep

            owtsweep.run(
                [
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
