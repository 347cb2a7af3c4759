"""Run independent parts of a script side by side, in as many processes as there are cores."""

from collections.abc import Mapping
from typing import Any

from joblib import Parallel, cpu_count

from owtsweep.io.steps import tell_step


def compute(jobs: Mapping[str, Any]) -> list[Any]:
    """Return the results of delayed calls, in their order; tell the name of each when it is done.

    `jobs` maps names to calls that joblib's `delayed` made.
    """
    results = Parallel(min(cpu_count(), len(jobs)), return_as="generator")(jobs.values())
    found = []
    for name, result in zip(jobs, results, strict=True):
        tell_step(name)
        found.append(result)
    return found
