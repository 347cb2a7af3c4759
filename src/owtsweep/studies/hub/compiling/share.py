"""A process that compiles some parts of the kernels, and prints the name of each finished part.

`python -m owtsweep.studies.hub.compiling.share superposed vectors prepare whole`

Kernels are compiled for the types of the arguments with which a study calls them. The types are
those of small examples; nothing is run. A study that calls a kernel with other types compiles the
kernel anew, so a wrong example costs time only. A test compares the examples with what a study
passes.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from owtsweep.studies.hub.kernels.layout import (
    NO_LEAN,
    WIDTH,
    ChainArrays,
    Fed,
    FilterArrays,
    HorizonArrays,
    Memory,
    PredictorArrays,
    Steps,
    Truth,
    Weights,
    new_output,
    new_registers,
    new_scratch,
)
from owtsweep.vectors import choose

#: Number of series that `gather` puts into lanes at once: eight replicates, and the last four of
#: the default study's twenty.
SERIES = (8, 4)


def examples(evaluation: str) -> dict[str, tuple[Any, ...]]:
    """Return name of a kernel -> example of the arguments with which a study calls the kernel."""
    groups = 3 if evaluation == "superposed" else 2
    C, D, row = np.zeros((1, 4, 4)), np.zeros((1, 4, 2)), np.zeros(4)
    rows = (np.zeros((1, WIDTH)),)
    chain = ChainArrays(
        FilterArrays(np.zeros((4, 4)), row, row, D, np.ones(1, np.bool_), C, D, 1, 0, 1, 1),
        PredictorArrays(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        HorizonArrays(
            False, np.zeros((1, 3, 1)), 1, 1, 0, False, 0, 0.0, np.zeros((1, 2, 3)), NO_LEAN
        ),
    )
    memory = Memory(new_registers(groups, 1, 1), new_scratch(groups, 1, 1), new_output(groups, 1))
    fed = Fed(rows * groups, 0, rows * groups)
    truth = Truth(rows, rows, np.zeros(2))
    weights = Weights(np.zeros((1, 3)), np.zeros(1), np.ones(1, np.bool_))
    squared = () if evaluation == "superposed" else (rows,)
    return {
        evaluation: ((0, 0, 1, 0), fed, truth, chain, weights, memory, rows, *squared),
        **_of_gains(C, D, row),
        "keep_lead": (0, np.zeros((1, 1, WIDTH))),
        "noise": (
            *(0, 0, np.zeros((1, 4, 1)), False, np.zeros((1, 2))),
            *((0.0, 0.0, 0.0, np.zeros(2)), np.zeros((3, 1, WIDTH))),
        ),
    }


def _of_gains(C: Any, D: Any, row: Any) -> dict[str, tuple[Any, ...]]:
    """Return the examples for the kernels of `estimation`, given two matrices and a row."""
    from owtsweep.estimation.riccati import GainRows, Pattern, TwoRates
    from owtsweep.estimation.windowing import FilterRows

    square = np.zeros((4, 4))
    transition = np.zeros((5, 5))[:4, :4]  # a part of a larger matrix: not contiguous
    model = TwoRates(transition, square, row, row, 0.0, 0.0, 0)
    filled = GainRows(D, np.zeros(1), C, C)
    return {
        "recursion": (0, 0, 0, model, square, Pattern(1, 1, 0), 0.0, filled),
        "leaving": (0, 0, C, D, 1, 1, D),
        "covariances": (FilterRows(C, C, C), 1, row, np.zeros((1, 3)), C, np.zeros((1, 4, 3)), 0),
    }


def compile_part(part: str, evaluation: str) -> None:
    """Compile one of `owtsweep.studies.hub.compiling.PARTS`, or load it if it is compiled."""
    from numba import typeof, types

    from owtsweep.estimation import riccati, windowing
    from owtsweep.studies.hub.kernels import chain, feeding, runs, sums
    from owtsweep.vectors.lanes import borrowed_type

    some = {name: tuple(map(typeof, given)) for name, given in examples(evaluation).items()}
    whole = some[evaluation]
    # inside a run, kernels take the run's arguments as borrowed
    fed, truth, arrays, weights, memory, total, *squared = map(borrowed_type, whole[1:])
    step, steps = types.int64, typeof(Steps(0, 0, 0, 0))
    velocity = borrowed_type(whole[2][1])
    if squared:  # `direct` sums into a tuple
        total = types.Tuple((total, *squared, types.boolean))
    series, lanes = typeof(np.zeros(1)), typeof(np.zeros((1, WIDTH)))
    gather = [(step, step, step, types.UniTuple(series, n), lanes) for n in SERIES]
    kernels: dict[str, list[tuple[Any, Any]]] = {
        "prepare": [
            (chain.prepare,
             (step, step, fed, arrays, memory, types.literal(False), velocity)),
        ],
        "span": [
            (getattr(sums, f"{evaluation}_span"),
             (steps, fed, truth, arrays, memory, weights, total, step)),
        ],
        "finish": [(chain.finish, (steps, fed, arrays, memory, velocity))],
        "recursion": [(riccati.recursion, some["recursion"])],
        "covariances": [(windowing.covariances, some["covariances"])],
        "leaving": [(windowing.leaving, some["leaving"])],
        "feeding": [
            (feeding.keep_lead, some["keep_lead"]),
            (feeding.noise, some["noise"]),
            *((feeding.gather, types_of_one) for types_of_one in gather),
        ],
        "whole": [(getattr(runs, evaluation), whole)],
    }  # fmt: skip
    for kernel, kinds in kernels[part]:
        kernel.compile(kinds)


def main(evaluation: str, form: str, *parts: str, tell: Callable[..., None] = print) -> None:
    """Compile the parts one after the other, with LLVM vectors if `form` is "vectors"."""
    choose(form == "vectors")
    gc.disable()  # collecting takes a tenth of the time, and finds little
    for part in parts:
        compile_part(part, evaluation)
        tell(part, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
