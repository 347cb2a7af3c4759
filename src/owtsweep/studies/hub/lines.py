"""The chains of the baselines: estimates that follow straight lines between position fixes."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import aligned
from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.gains import GainSchedule
from owtsweep.studies.hub.chain import NO_HORIZON, Chain, Line
from owtsweep.studies.hub.kernels.layout import FilterArrays, PredictorArrays
from owtsweep.studies.hub.models import AxisFilter
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
    )  # fmt: skip
