"""The baselines of the hub study, which use nothing but the position fixes.

NONE: position and velocity are zero. HOLD: the last fix is held until the next one; the velocity is
zero. DELTA: the last fix, moved on to the present with the velocity of the last two fixes.

Where NONE has less error than every scheme, the motion is too small for these sensors; where HOLD
or DELTA has, the IMU is of no use.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.gains import GainSchedule
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import NO_HORIZON, Chain
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.kernels.layout import FilterArrays, PredictorArrays
from owtsweep.studies.hub.schemes.chained import ChainScheme
from owtsweep.studies.hub.sensors import Sensors


class LineEstimator:
    """An estimator that follows a baseline's line from the last fix to the present, step by step.

    Before the first fix everything is zero; before the second the slope is.
    """

    def __init__(self, sensors: Sensors, line: Baseline) -> None:
        self.step, self.delay, self.line = sensors.step, sensors.delay, line
        self.fix: Array = np.zeros(2)
        self.velocity: Array = np.zeros(2)
        self.age: int | None = None  # number of steps since the last fix arrived

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        if self.age is not None:
            self.age += 1
        if position is not None and self.line.holds:
            if self.age is not None and self.line.moves:
                self.velocity = (position - self.fix) / (self.age * self.step)
            self.fix = np.array(position, dtype=float)
            self.age = 0
        ahead = (self.delay + (self.age or 0)) * self.step
        return Estimate(self.fix + ahead * self.velocity, self.velocity)


class Baseline(ChainScheme):
    """A baseline, which no key tunes: the straight line from one position fix to the next.

    holds: whether the line starts from the last fix; otherwise it is zero.
    moves: whether the line has the slope between the last two fixes, and is at the present, a delay
        ahead of the last fix; otherwise its slope is zero.
    """

    sections = ()

    def __init__(self, name: str, *, holds: bool, moves: bool) -> None:
        self.name, self.holds, self.moves = name, holds, moves

    def start(self, known: Known) -> LineEstimator:
        return LineEstimator(known.sensors, self)

    def make_chain(self, known: Known, steps: int) -> Chain:
        """Make the chain whose estimates follow straight lines from one position fix to the next.

        It takes no account of the specific force, and states no covariance. Its state is that of
        the delayed time, to which the fixes belong; the predictor takes it to the present.
        """
        sensors = known.sensors
        gains = [[float(self.holds), 0.0]]
        if self.moves:
            # The state moves on with its velocity, so a fix differs from it by the change of the
            # slope times the time between two fixes.
            gains.append([1.0, 1.0 / sensors.fix_step])
        ahead = sensors.delay if self.moves else 0
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
            axis=None,
            input_model=None,
        )  # fmt: skip


NONE = Baseline("NONE", holds=False, moves=False)
HOLD = Baseline("HOLD", holds=True, moves=False)
DELTA = Baseline("DELTA", holds=True, moves=True)
