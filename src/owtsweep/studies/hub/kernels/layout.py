"""The arrays that the batch engine's kernels take: a scheme, its input, its memory.

Kernels run all lanes of a row side by side: their innermost loops run over the lanes, and LLVM
makes vectors of them. For that, a row is a record whose fields have a fixed number of lanes, so the
compiler knows that fields do not overlap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, Rows

#: Number of records that run side by side; a record has two or three lanes.
WIDTH = 8

#: Which IMU samples the MHE takes, in the order of `hub.horizon.INPUTS`.
ALL, AVERAGED, SAMPLED = 0, 1, 2

#: The fields of a state: position, velocity, acceleration, bias.
STATE = ("p", "v", "a", "b")


class FilterArrays(NamedTuple):
    """The filter and smoother along one axis; states are position, velocity, acceleration, bias.

    A, B, h: transition matrix (4, 4), input column (4,), and measurement row (4,) of specific
        force.
    K: the filter's gains, shape (rows, 4, 2); the last axis is position, specific force.
    applied: whether the position is used at a step with this row of K, shape (rows,).
    C, D: the smoother's gains (rows, 4, 4), and those for innovations that leave the window
        (rows, 4, 2).
    cycle: after the last row of K, C and D, the last `cycle` rows repeat.
    input_delay, window, fix_interval: delay of the specific force, the smoother's lag, and time
        between fixes, all in steps.
    """

    A: Array
    B: Array
    h: Array
    K: Array
    applied: NDArray[np.bool_]
    C: Array
    D: Array
    cycle: int
    input_delay: int
    window: int
    fix_interval: int


class LeanTerms(NamedTuple):
    """What an IMU that leans as it moves adds in one step of integrating its specific force.

    The position also grows by `pp` times itself, `pv` times the velocity and `pu` times the input;
    the velocity by `vp`, `vv` and `vu` times these three. All are zero without a lean.
    """

    pp: float
    pv: float
    pu: float
    vp: float
    vv: float
    vu: float


NO_LEAN = LeanTerms(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class PredictorArrays(NamedTuple):
    """A prediction without measurements over `steps` steps of `step` seconds.

    The states are position, velocity, bias. In one step a unit of input adds `half` to the position
    (step^2 / 2 if inputs are held). Over all steps, a unit of velocity adds `pv` to the position,
    and a unit of bias adds `pb` to the position and `vb` to the velocity. An IMU that leans
    (`lean`) also has a unit of position add `pp` to the position and `vp` to the velocity, and a
    unit of velocity add `vv` to the velocity; an input that is older than all steps has left
    `old_p` in the position and `old_v`, beside `step`, in the velocity. If inputs are linear
    between samples, `new_p` and `new_v` times the newest input are added to position and velocity,
    and `first_p` and `first_v` times the first input of the prediction are subtracted.
    """

    steps: int
    step: float
    half: float
    pv: float
    pb: float
    vb: float
    old_p: float
    old_v: float = 0.0
    pp: float = 0.0
    vp: float = 0.0
    vv: float = 0.0
    lean: LeanTerms = NO_LEAN
    new_p: float = 0.0
    new_v: float = 0.0
    first_p: float = 0.0
    first_v: float = 0.0


class HorizonArrays(NamedTuple):
    """The MHE without constraints: matrices that turn data into states.

    active: whether the scheme has an MHE.
    maps: one matrix (3, columns) per number of a fix; the last matrix serves all later fixes. The
        columns are explained in `estimation.mhe.window_maps`.
    horizon: N_m, the number of intervals between fixes in a full window.
    interval: T_m, the time between the MHE's positions, in steps.
    first: number of the first fix at which the window can be solved.
    arrival: whether the window has an arrival state (a prior of its oldest state).
    inputs: which IMU samples are taken: ALL, AVERAGED or SAMPLED.
    step: sampling interval of the IMU, s.
    growth: as of `hub.horizon.growth_over` after the last fix, shape (steps between fixes, 2, 3).
    """

    active: bool
    maps: Array
    horizon: int
    interval: int
    first: int
    arrival: bool
    inputs: int
    step: float
    growth: Array
    lean: LeanTerms


class ChainArrays(NamedTuple):
    filter: FilterArrays
    predictor: PredictorArrays
    mhe: HorizonArrays


class Fed(NamedTuple):
    """The data on which a scheme is run.

    force: specific force, m/s^2, shape (rows, lanes); that of step k is in row k - base.
    fixes: position fixes, m, shape (fixes, lanes).
    """

    force: Array
    base: int
    fixes: Array


class Truth(NamedTuple):
    """The true motion, with which the estimates are compared.

    motion: displacement along the wave (m) at unit amplitude in the first `WIDTH` columns, and its
        rate (m/s) in the others; shape (rows, 2 WIDTH). Step k is in the same row as in `Fed`.
    direction: the wave's direction cosines along x and y, times the amplitude of the motion in m (1
        if motion and noise are run apart); shape (2,).
    """

    motion: Array
    direction: Array


class Weights(NamedTuple):
    """The weights of squared errors in NEES and NIS, one row per row of the gain schedule.

    NEES is the normalised estimation error squared, NIS the normalised innovation squared.

    precision: elements pp, pv, vv of the inverse covariance of position p and velocity v along an
        axis, shape (rows, 3).
    innovation, fresh: inverse of the innovation's variance, and whether there is an innovation,
        shape (rows,).
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]


class Memory(NamedTuple):
    """The memory of a running scheme, all zero at first, as the algorithms of the paper start.

    steps: one row per step, with the fields p, v, a, b (the state) and the innovations r of the
        specific force and s of the position. Row 0 is the filter's state before the chunk; the next
        `window` rows are kept from the chunk before; the filter writes step k0 + i, where k0 is the
        chunk's first step, to row 1 + window + i. Smoother and predictor then replace what stands
        in the rows 1, 2, ...: in the end row 1 + i holds the estimate of step k0 + i.
    back: the smoother's correction p, v, a, b; one row.
    inputs: what the inputs (specific forces) of the prediction add to position and velocity: p, v;
        one row.
    nodes: the MHE's window, registers 2 and 3 of the paper; fix number q is in row q modulo the
        number of rows. Fields: the fix z; what the inputs until the next fix add to position and
        velocity, ip and iv; the filter's state p, v, b.
    now: the MHE between two fixes; one row. Fields: p and v, what the inputs since the last fix add
        to position and velocity; the sum of the IMU samples since the last multiple of T_m, and the
        sample or average taken until the next; np, nv, nb, the MHE's state at the last fix.
    position: the MHE's newest position, which the filter takes, m, shape (1, lanes).
    """

    steps: Rows
    back: Rows
    inputs: Rows
    nodes: Rows
    now: Rows
    position: Array
