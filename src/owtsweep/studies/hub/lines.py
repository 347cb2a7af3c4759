"""The baselines of the hub study: estimates that follow straight lines between position fixes.

`sum_line_errors` sums their squared errors without a run: between two fixes a line's squared error
is a polynomial in few sums over the true motion, which all lines share. These sums take a small
part of the time of a chain's run, and give the same numbers to rounding.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.gains import GainSchedule
from owtsweep.studies.hub.chain import NO_HORIZON, Chain, Line
from owtsweep.studies.hub.kernels.layout import WIDTH, FilterArrays, PredictorArrays
from owtsweep.studies.hub.models import AxisFilter
from owtsweep.studies.hub.records import Feed
from owtsweep.studies.hub.sensors import Sensors


def fix_chain(sensors: Sensors, line: Line) -> Chain:
    """Make the chain whose estimates follow straight lines from one position fix to the next.

    It takes no account of the specific force, and states no covariance. Its state is that of the
    delayed time, to which the fixes belong; the predictor takes it to the present.
    """
    gains = [[float(line.holds), 0.0]]
    if line.moves:
        # The state moves on with its velocity, so a fix differs from it by the change of the slope
        # times the time between two fixes.
        gains.append([1.0, 1.0 / sensors.fix_step])
    ahead = sensors.delay if line.moves else 0
    M, step = sensors.fix_interval, sensors.step
    rows = M * len(gains)
    K = aligned(rows, 4, 2)
    K[::M, :2, 0] = gains
    A = np.eye(4)
    A[0, 1] = step
    unknown = np.broadcast_to(np.nan, (rows, 4, 4))
    applied = np.arange(rows) % M == 0
    return Chain(
        gains=GainSchedule(
            K=K,
            applied=applied,
            # no innovation has a known variance, so none is judged
            fresh=np.zeros(rows, dtype=bool),
            innovation_variance=np.full(rows, np.nan),
            predicted=unknown,
            filtered=unknown,
            cycle=M,
        ),
        filter=FilterArrays(
            A=A, B=np.zeros(4), h=np.zeros(4), K=K, applied=applied, C=np.zeros((1, 4, 4)),
            D=np.zeros((1, 4, 2)), cycle=M, input_delay=0, window=0, fix_interval=M,
        ),
        # with steps of no length, the predictor adds up no specific force
        predictor=PredictorArrays(
            steps=ahead, step=0.0, half=0.0, pv=ahead * step, pb=0.0, vb=0.0, old_p=0.0
        ),
        mhe=NO_HORIZON,
        axis=AxisFilter(
            model=Discrete(A=A, B=np.zeros((4, 1)), Q=np.full((4, 4), np.nan), step=step),
            force_row=np.zeros(4),
            position_variance=np.nan,
            force_variance=np.nan,
            initial_covariance=np.full((4, 4), np.nan),
        ),
        input_model=None,
        line=line,
    )  # fmt: skip


class Piece(NamedTuple):
    """Sums over the true motion within some intervals from fix to fix, or parts of intervals.

    fixes: the numbers of the fixes with which the intervals begin.
    times: number of steps, and sums of the time since the fix (s) and of its square (s^2), equal
        for all intervals.
    position: sums of the displacement (m), and of the displacement times the time since the fix
        (m s); shape (2, 8, intervals).
    velocity: sums of the velocity (m/s), shape (8, intervals).
    squares: sums of squared displacement and of squared velocity over all intervals, shape (2, 8).
    """

    fixes: slice
    times: tuple[float, float, float]
    position: Array
    velocity: Array
    squares: Array


def sum_line_errors(lines: Sequence[Line], feed: Feed, settled: int) -> list[Array]:
    """Sum the squared errors of lines on the records of a feed, which keeps motion and noise apart.

    For each line return the sums as `layout.products` arranges them; NEES and NIS are 0.
    """
    records = feed.records
    fixes = np.ascontiguousarray(feed.fixes.T).reshape(3, WIDTH, -1)
    drawn = [line.through(fixes, records.sensors) for line in lines]
    result: list[Array] = [np.zeros((2, 6, 3, WIDTH)) for _ in lines]
    for window, (begin, stop) in enumerate(((0, settled), (settled, records.steps))):
        for piece in _cut(feed, begin, stop):
            for (start, slope), sums in zip(drawn, result, strict=True):
                some = start[..., piece.fixes], slope[..., piece.fixes]
                for quantity, products in zip((0, 2), _multiply(*some, piece), strict=True):
                    for axis, cosine in enumerate(records.direction):
                        row = sums[window, quantity + axis]
                        row[0] += cosine**2 * products[0, 0]
                        row[1] += cosine * products[0, 1 + axis]
                        row[2] += products[1 + axis, 1 + axis]
    return result


def _cut(feed: Feed, begin: int, stop: int) -> Iterator[Piece]:
    """Cut the steps begin ... stop - 1 into pieces of equal intervals: at most three pieces."""
    M = feed.records.sensors.fix_interval
    while begin < stop:
        since = begin % M
        if since == 0 and stop - begin >= M:
            count, each = (stop - begin) // M, M
        else:
            count, each = 1, min(M - since, stop - begin)
        yield _sum_motion(feed, begin, count, each)
        begin += count * each


def _sum_motion(feed: Feed, begin: int, count: int, each: int) -> Piece:
    """Sum over `count` intervals of `each` steps; the first one begins at the step `begin`."""
    records = feed.records
    M, step = records.sensors.fix_interval, records.sensors.step
    time = step * (begin % M + np.arange(each))
    position, velocity = np.zeros((2, WIDTH, count)), np.zeros((WIDTH, count))
    squares = np.zeros((2, WIDTH))
    for lane, index in enumerate(feed.indices):
        motion = records.motion[index]
        p, v = (
            series[begin : begin + count * each].reshape(count, each)
            for series in (motion.position, motion.velocity)
        )
        # by einsum: its order of terms depends on the shapes alone, unlike that of a BLAS
        position[0, lane] = np.einsum("ij->i", p)
        position[1, lane] = np.einsum("ij,j->i", p, time)
        velocity[lane] = np.einsum("ij->i", v)
        squares[:, lane] = np.einsum("ij,ij->", p, p), np.einsum("ij,ij->", v, v)
    first = begin // M
    times = (float(each), float(np.sum(time)), float(np.sum(time**2)))
    return Piece(slice(first, first + count), times, position, velocity, squares)


def _multiply(start: Array, slope: Array, piece: Piece) -> tuple[Array, Array]:
    """Sum the products of the errors of each pair of groups over the steps of a piece.

    The groups are motion, noise of x and noise of y. At the time t after a fix, the error of the
    position is start + slope t, and that of the velocity is slope; in the group motion, the true
    displacement and its rate are subtracted. `start` and `slope` have the shape (3, 8, intervals),
    the sums for position and for velocity (3, 3, 8).
    """
    n, t, tt = piece.times
    crossed = _pairs(start, slope)
    slopes = _pairs(slope, slope)
    position = n * _pairs(start, start) + t * (crossed + crossed.swapaxes(0, 1)) + tt * slopes
    velocity = n * slopes
    with_position = _single(start, piece.position[0]) + _single(slope, piece.position[1])
    for sums, with_motion, squares in (
        (position, with_position, piece.squares[0]),
        (velocity, _single(slope, piece.velocity), piece.squares[1]),
    ):
        sums[0] -= with_motion
        sums[:, 0] -= with_motion
        sums[0, 0] += squares
    return position, velocity


def _pairs(one: Array, other: Array) -> Array:
    """Sum products of two groups over the intervals, for each lane; shape (3, 3, 8)."""
    return np.asarray(np.einsum("glk,hlk->ghl", one, other))


def _single(line: Array, motion: Array) -> Array:
    """Sum products of each group with the motion over the intervals; shape (3, 8)."""
    return np.asarray(np.einsum("glk,lk->gl", line, motion))
