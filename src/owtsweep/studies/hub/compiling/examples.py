"""Examples of the arguments with which kernels are called; kernels are compiled for their types.

Nothing is run with the examples. A command that calls a kernel with arguments of other types
compiles the kernel anew, so a wrong example costs time only. A test compares the examples with what
commands pass.
"""

from __future__ import annotations

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
    Truth,
    Weights,
    new_output,
    new_registers,
    new_scratch,
)

#: Use of kernels -> number of groups of eight series that run side by side.
GROUPS = {"superposed": 3, "direct": 2, "expected": 2, "recorded": 1}

Examples = dict[str, tuple[Any, ...]]

_ROW, _ROWS = np.zeros(4), (np.zeros((1, WIDTH)),)
_C, _D = np.zeros((1, 4, 4)), np.zeros((1, 4, 2))


def list_examples(use: str) -> Examples:
    """Return name of a kernel -> example of its arguments, for a use in `compiling.PARTS`."""
    if use == "gains":
        return _of_gains()
    if use == "online":
        return _of_online()
    if use == "expected":
        return _of_expected()
    if use == "recorded":
        parts = (0, 0, *_of_series(use))
        return {"estimates": parts, "states": (*parts, _ROWS)}
    return _of_records(use)


def _of_series(use: str) -> tuple[Fed, ChainArrays, Memory]:
    """Return series, a scheme as arrays, and its memory."""
    groups, row = GROUPS[use], _ROW
    chain = ChainArrays(
        FilterArrays(np.zeros((4, 4)), row, row, _D, np.ones(1, np.bool_), _C, _D, 1, 0, 1, 1),
        PredictorArrays(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        HorizonArrays(
            False, np.zeros((1, 3, 1)), 1, 1, 0, False, 0, 0.0, np.zeros((1, 2, 3)), NO_LEAN
        ),
    )
    memory = Memory(new_registers(groups, 1, 1), new_scratch(groups, 1, 1), new_output(groups, 1))
    return Fed(_ROWS * groups, 0, _ROWS * groups), chain, memory


def _of_records(use: str) -> Examples:
    """Return the examples for the kernels that make and run simulated records."""
    fed, chain, memory = _of_series(use)
    weights = Weights(np.zeros((1, 3)), np.zeros(1), np.ones(1, np.bool_))
    squared = () if use == "superposed" else (_ROWS,)
    truth = Truth(_ROWS, _ROWS, np.zeros(2))
    return {
        use: ((0, 0, 1, 0), fed, truth, chain, weights, memory, _ROWS, *squared),
        "keep_lead": (0, np.zeros((1, 1, WIDTH))),
        "noise": (
            *(0, 0, np.zeros((1, 4, 1)), False, np.zeros((1, 2))),
            *((0.0, 0.0, 0.0, np.zeros(2)), np.zeros((3, 1, WIDTH))),
        ),
    }


def _of_expected() -> Examples:
    """Return the examples for the kernels of the expected engine."""
    from owtsweep.studies.hub.error_curves.layout import Buffers, Course, Waves

    fed, chain, memory = _of_series("expected")
    (rows,), two = _ROWS, _ROWS * 2
    waves = Waves(rows, rows, rows, rows, 1, True, True, True)
    buffers = Buffers(np.zeros(2, np.int64), two, two, two, rows, rows)
    course = Course(0, 1, 0, 1, 1, 1, 0.0)
    return {
        "advance": (0, 0, 0, course, waves, buffers, chain, memory),
        "add_squares": (0, 0, course, waves, buffers, memory.output),
        "make_waves": (0, waves, buffers),
        "estimates": (0, 0, fed, chain, memory),
    }


def _of_gains() -> Examples:
    """Return the examples for the kernels of `estimation`."""
    from owtsweep.estimation.riccati import GainRows, Pattern, TwoRates
    from owtsweep.estimation.windowing import FilterRows

    C, D, row, square = _C, _D, _ROW, np.zeros((4, 4))
    transition = np.zeros((5, 5))[:4, :4]  # a part of a larger matrix: not contiguous
    model = TwoRates(transition, square, row, row, 0.0, 0.0, 0)
    filled = GainRows(D, np.zeros(1), C, C)
    return {
        "recursion": (0, 0, 0, model, square, Pattern(1, 1, 0), 0.0, filled),
        "leaving": (0, 0, C, D, 1, 1, D),
        "covariances": (FilterRows(C, C, C), 1, row, np.zeros((1, 3)), C, np.zeros((1, 4, 3)), 0),
    }


def _of_online() -> Examples:
    """Return the examples for the kernels of online estimators."""
    from owtsweep.studies.hub.kernels.online_layout import (
        FilterSettings,
        HorizonSettings,
        OnlineEstimates,
    )
    from owtsweep.studies.hub.online.registers import new_registers

    row, square, three = _ROW, np.zeros((4, 4)), np.zeros((3, 3))
    two = np.zeros((1, 2))
    f = FilterSettings(
        square, row, square, row, row, 0.0, 0.0, 0, square, 1, 0, 0, True,
        three, np.zeros(3), np.zeros(3), three, np.zeros((1, 3)), three, np.zeros((2, 2)),
        np.zeros(2), 0, 0.0, 0,
    )  # fmt: skip
    h = HorizonSettings(
        False,
        1,
        1,
        0,
        0,
        0.0,
        three,
        three,
        0.0,
        three,
        False,
        np.zeros(3),
        np.zeros((1, 2, 3)),
        NO_LEAN,
        0,
        0.0,
    )
    m = new_registers(f, h)
    estimates = OnlineEstimates(np.zeros((1, 4)), np.zeros((1, 2, 2)), two, np.zeros(1))
    return {
        "advance": (0, False, (two, two), f, h, m, estimates),
        "take_fix": (True, two[0], f, h, m),
        "horizon_position": (f, h, m),
        "horizon_has_position": (f, h, m),
        "take_sample": (two[0], f, m),
        "filter_step": (True, f, m),
        "after_filter": (f, h, m),
        "output": (f, m, estimates.state[0], estimates.covariance[0]),
    }
