"""The structures of arrays that the batch engine's kernels take.

A chain is a scheme as arrays. A lane is one series of numbers along one axis, and eight lanes make
a group. A chunk is a stretch of a record whose steps are computed together.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.vectors import WIDTH as WIDTH  # imported from here elsewhere

#: Which IMU samples the moving horizon estimator (MHE) takes, in the order of `hub.horizon.INPUTS`.
ALL, AVERAGED, SAMPLED = 0, 1, 2

#: One array per group of eight lanes; kernels process all groups side by side.
Groups = tuple[Array, ...]


class FilterArrays(NamedTuple):
    """The filter and smoother along one axis; states are position, velocity, acceleration, bias.

    Attributes
    ----------
    A, B, h
        Transition matrix (4, 4), input column (4,), and measurement row (4,) of specific force.
    K
        The filter's gains, shape (rows, 4, 2); the last axis is position, specific force.
    applied
        Whether the position is used at a step with this row of K, shape (rows,).
    C, D
        The smoother's gains (rows, 4, 4), and its gains for the innovations that leave the window
        (rows, 4, 2).
    cycle
        K, C and D have one row per step. After the last row, the last `cycle` rows repeat.
    input_delay, window, fix_interval
        Delay of the specific force, length of the smoother's window, and time between fixes, all in
        steps.
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

    In one step the position also grows by `pp` times itself, `pv` times the velocity and `pu` times
    the input; the velocity by `vp`, `vv` and `vu` times these three. All are zero without a lean.
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
    `old_p` in the position and `old_v`, beside `step`, in the velocity. If inputs are `linear`
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
    linear: bool = False
    new_p: float = 0.0
    new_v: float = 0.0
    first_p: float = 0.0
    first_v: float = 0.0


class HorizonArrays(NamedTuple):
    """The moving horizon estimator (MHE) without constraints: matrices that turn data into states.

    Attributes
    ----------
    active
        Whether the scheme has an MHE.
    maps
        One matrix (3, columns) per number of a fix; the last matrix serves all later fixes. The
        columns are explained in `estimation.mhe.window_map`.
    horizon
        N_m, the number of intervals between fixes in a full window of the MHE.
    interval
        T_m, the time between the MHE's positions, in steps.
    first
        Number of the first fix at which the MHE's window can be solved.
    arrival
        Whether the MHE's window has an arrival state (a prior of its oldest state).
    inputs
        Which IMU samples are taken: ALL, AVERAGED or SAMPLED.
    step
        Sampling interval of the IMU, s.
    growth
        What a state at the last fix adds to position and velocity, beside itself, k steps later;
        shape (steps between fixes, 2, 3), see `hub.horizon.growth_over`.
    lean
        What an IMU that leans adds in one step.
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
    """The arrays of a whole scheme: filter with smoother, predictor, moving horizon estimator."""

    filter: FilterArrays
    predictor: PredictorArrays
    mhe: HorizonArrays


class Registers(NamedTuple):
    """The memory that each lane (series) carries from one chunk of steps to the next.

    Each field has an array (rows, 8) for each group of eight lanes. Below, `window` is the length
    of the smoother's window in steps. The MHE is the moving horizon estimator; `horizon` is the
    number of intervals between fixes in its window, and T_m the time between its positions.

    Attributes
    ----------
    x
        The filter's state; 4 rows.
    r, s
        The newest innovations of specific force and of position; `window` rows each.
    X
        The newest filtered states; 4 x window rows.
    z
        The position fixes in the MHE's window; horizon + 1 rows.
    ip, iv
        What the inputs (specific forces) between two fixes of the MHE's window add to position and
        to velocity; `horizon` rows each.
    arrival
        Filtered states at past fixes; 3 (horizon + 1) rows: position, velocity, bias of each.
    running
        What the inputs since the last fix add to position (row 0) and to velocity (row 1); the sum
        of the IMU samples since the last multiple of T_m (row 2); the sample or average that the
        MHE takes until the next multiple (row 3).
    node
        The MHE's state at the newest fix; 3 rows.
    fix
        The MHE's newest position, which the filter takes; 1 row.
    """

    x: Groups
    r: Groups
    s: Groups
    X: Groups
    z: Groups
    ip: Groups
    iv: Groups
    arrival: Groups
    running: Groups
    node: Groups
    fix: Groups


class Scratch(NamedTuple):
    """The memory that is used only within a chunk of steps.

    All runs share this memory, so it stays in the cache. Each field has an array (rows, 8) for each
    group of eight lanes. Below, `chunk` is the number of steps of a chunk, and `window` the length
    of the smoother's window in steps.

    Attributes
    ----------
    r, s
        Innovations of specific force and of position; window + chunk rows each.
    X
        States, up to four rows per step; 4 (window + chunk) rows.
    inputs
        What the inputs (specific forces) add to the predicted velocity and position; 2 rows.
    positions
        The positions that the moving horizon estimator gives the filter; `chunk` rows, of which as
        many are used as there are positions.
    """

    r: Groups
    s: Groups
    X: Groups
    inputs: Groups
    positions: Groups


class Output(NamedTuple):
    """The estimates of a chunk of steps: position (m), velocity (m/s), and innovation (m).

    Each field has an array (steps, 8) for each group of eight lanes. The innovation is the
    difference between the position that the filter takes and its prediction.
    """

    position: Groups
    velocity: Groups
    innovation: Groups


class Memory(NamedTuple):
    """The memory of a running scheme: registers, working memory, and the newest estimates."""

    registers: Registers
    scratch: Scratch
    output: Output


class Fed(NamedTuple):
    """The data on which a scheme is run.

    Attributes
    ----------
    force
        Specific force, m/s^2; an array (rows, 8) for each group of eight lanes.
    base
        The specific force of step k is in row k - base.
    fixes
        Position fixes, m; an array (fixes, 8) for each group of eight lanes.
    """

    force: Groups
    base: int
    fixes: Groups


class Truth(NamedTuple):
    """The true motion, with which the estimates are compared.

    Attributes
    ----------
    position, velocity
        Displacement along the wave (m) at unit amplitude, and its rate (m/s). Each is a tuple of
        one array (rows, 8). Step k is in the same row as in `Fed`.
    direction
        The wave's direction cosines along x and y, times the amplitude of the motion in m (1 if
        motion and noise are run apart); shape (2,).
    """

    position: Groups
    velocity: Groups
    direction: Array


class Steps(NamedTuple):
    """The steps first ... stop - 1 of a chunk, a stretch of a record that begins at step k0.

    The estimate of the chunk's step i is in row i - shift of the output.
    """

    k0: int
    first: int
    stop: int
    shift: int


def new_registers(groups: int, window: int, horizon: int) -> Registers:
    """Make registers, all zero, for `groups` groups of eight lanes.

    The algorithms of Ren et al. (2019) start from zero. `window` is the length of the smoother's
    window in steps. `horizon` is the number of intervals between fixes in the MHE's window.
    """
    rows = (
        4, window, window, 4 * window, horizon + 1, horizon, horizon, 3 * (horizon + 1), 4, 3, 1,
    )  # fmt: skip
    # slices of one array: making eleven arrays takes longer than a short run
    block = aligned(groups, sum(max(n, 1) for n in rows), WIDTH)
    stops = np.cumsum([max(n, 1) for n in rows]).tolist()
    return Registers(*(tuple(block[:, a:b]) for a, b in pairwise([0, *stops])))


def new_scratch(groups: int, chunk: int, window: int) -> Scratch:
    """Make working memory for `groups` groups of eight lanes, all zero.

    `chunk` is the number of steps that are computed together, `window` the length of the smoother's
    window in steps.
    """
    steps = window + chunk
    rows = (steps, steps, 4 * steps, 2, chunk)
    return Scratch(*(_zeros(groups, n) for n in rows))


def new_output(groups: int, chunk: int) -> Output:
    """Make memory, all zero, for estimates of `chunk` steps in `groups` groups of eight lanes."""
    return Output(*(_zeros(groups, chunk) for _ in Output._fields))


def _zeros(groups: int, rows: int) -> Groups:
    return tuple(aligned(groups, rows, WIDTH))


class Weights(NamedTuple):
    """The weights of squared errors in NEES and NIS, one row per row of the gain schedule.

    NEES is the normalised estimation error squared, NIS the normalised innovation squared.

    Attributes
    ----------
    precision
        Elements pp, pv, vv of the inverse covariance of position p and velocity v along an axis,
        shape (rows, 3).
    innovation, fresh
        Inverse of the innovation's variance, and whether there is an innovation, shape (rows,).
    """

    precision: Array
    innovation: Array
    fresh: NDArray[np.bool_]
