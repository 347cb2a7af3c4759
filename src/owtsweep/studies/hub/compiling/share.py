"""A process that compiles some parts of the kernels, and prints the name of each finished part.

`python -m owtsweep.studies.hub.compiling.share vectors superposed.prepare superposed.whole`
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from owtsweep import compiled  # in this form the module counts as no source of kernels
from owtsweep.studies.hub.compiling.examples import list_examples
from owtsweep.studies.hub.kernels.layout import WIDTH, Steps
from owtsweep.vectors import choose

#: Number of series that `gather` puts into lanes at once: eight replicates, and the last four of
#: the default study's twenty.
SERIES = (8, 4)

#: Part -> the kernels that belong to it, each with the types of its arguments.
Parts = dict[str, list[tuple[Any, Any]]]
Types = dict[str, tuple[Any, ...]]


def compile_part(name: str) -> None:
    """Compile the part `name`, written as use.part, or load the part if it is compiled."""
    from numba import typeof

    use, part = name.split(".")
    some = {name: tuple(map(typeof, given)) for name, given in list_examples(use).items()}
    for kernel, types in list_parts(use, some)[part]:
        kernel.compile(types)


def list_parts(use: str, some: Types) -> Parts:
    """Return the parts of a use, given name of a kernel -> types of its arguments."""
    if use == "gains":
        return _of_gains(some)
    if use == "online":
        return _of_online(some)
    if use in ("superposed", "direct"):
        return _of_records(use, some)
    return _of_given_series(use, some)


def _of_gains(some: Types) -> Parts:
    """List the kernels that compute the gains of filter and smoother."""
    from owtsweep.estimation import riccati, windowing

    return {
        "recursion": [(riccati.recursion, some["recursion"])],
        "covariances": [(windowing.covariances, some["covariances"])],
        "leaving": [(windowing.leaving, some["leaving"])],
    }


def _of_online(some: Types) -> Parts:
    """List the kernels of online estimators."""
    from owtsweep.studies.hub.kernels import online

    parts = {
        "horizon": ["take_fix", "horizon_position", "horizon_has_position"],
        "output": ["output"],
        "filter": ["filter_step", "take_sample", "after_filter"],
        "whole": ["advance"],
    }
    return {
        part: [(getattr(online, name), some[name]) for name in names]
        for part, names in parts.items()
    }


def _of_given_series(use: str, some: Types) -> Parts:
    """List the kernels of a use that runs a scheme over given series, or over sinusoids."""
    from owtsweep.studies.hub.kernels import runs

    fed, chain, memory = some["estimates"][2:]
    parts = _of_chain(fed, chain, memory, fed[0])
    if use == "recorded":
        parts["whole"] = [(getattr(runs, name), some[name]) for name in ("estimates", "states")]
        return parts
    from owtsweep.studies.hub.error_curves import kernels

    parts["squares"] = [
        (getattr(kernels, name), some[name]) for name in ("add_squares", "make_waves")
    ]
    parts["whole"] = [(kernels.advance, some["advance"])]
    return parts


def _of_records(use: str, some: Types) -> Parts:
    """List the kernels that make simulated records and run a scheme over them."""
    from numba import typeof, types

    from owtsweep.studies.hub.kernels import feeding, runs, sums
    from owtsweep.vectors.lanes import borrowed_type

    fed, truth, chain, _, memory, *_ = some[use][1:]
    parts = _of_chain(fed, chain, memory, truth[1])
    # inside a run, kernels take the run's arguments as borrowed
    inputs, true, arrays, weighed, work, summed, *kept = map(borrowed_type, some[use][1:])
    if kept:  # `direct` sums into a tuple
        summed = types.Tuple((summed, *kept, types.boolean))
    step, steps = types.int64, typeof(Steps(0, 0, 0, 0))
    span = (steps, inputs, true, arrays, work, weighed, summed, step)
    series, lanes = typeof(np.zeros(1)), typeof(np.zeros((1, WIDTH)))
    gather = [(step, step, step, types.UniTuple(series, n), lanes) for n in SERIES]
    parts["span"] = [(getattr(sums, f"{use}_span"), span)]
    parts["feeding"] = [
        (feeding.keep_lead, some["keep_lead"]),
        (feeding.noise, some["noise"]),
        *((feeding.gather, types_of_one) for types_of_one in gather),
    ]
    parts["whole"] = [(getattr(runs, use), some[use])]
    return parts


def _of_chain(fed: Any, chain: Any, memory: Any, ahead: Any) -> Parts:
    """List the two kernels that run a scheme over a chunk of steps, called inside a run.

    The arguments are the types of series, scheme, memory and of the data that is prefetched.
    """
    from numba import typeof, types

    from owtsweep.studies.hub.kernels.chain import finish, prepare
    from owtsweep.vectors.lanes import borrowed_type

    # inside a run, kernels take the run's arguments as borrowed
    inside = tuple(map(borrowed_type, (fed, chain, memory)))
    step, steps, data = types.int64, typeof(Steps(0, 0, 0, 0)), borrowed_type(ahead)
    return {
        "prepare": [(prepare, (step, step, *inside, types.literal(False), data))],
        "finish": [(finish, (steps, *inside, data))],
    }


def write_in_turn() -> None:
    """Let one process at a time write to the folder of compiled kernels.

    numba reads the index of a kernel's compiled forms, adds a form, and writes the index. If two
    processes did so at once, e.g. for two uses of a kernel, a form could be stored under the name
    of another.
    """
    with suppress(ImportError):  # not on Windows
        import fcntl

        from numba.core.caching import IndexDataCacheFile

        save = IndexDataCacheFile.save

        def save_alone(self: Any, *what: Any) -> None:
            with open(compiled.usable_directory() / "lock", "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                save(self, *what)

        IndexDataCacheFile.save = save_alone


def main(form: str, *parts: str, tell: Callable[..., None] = print) -> None:
    """Compile the parts one after the other, with LLVM vectors if `form` is "vectors"."""
    choose(form == "vectors")
    for part in parts:
        compile_part(part)
        tell(part, flush=True)


if __name__ == "__main__":
    gc.disable()  # collecting takes a tenth of the time, and finds little
    write_in_turn()
    main(*sys.argv[1:])
