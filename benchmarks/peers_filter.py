"""Compare the batched multirate Kalman filter with other software (peers) on one job.

The job is to filter one two-axis record (8 states, specific force at every step, fixes now and
then). Every peer gets the same matrices. The peer's states must agree with those of owtsweep to
1e-8 of each state's largest magnitude; otherwise the report says that they do not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks import STUDY
from benchmarks.timing import REPEATS, seconds
from owtsweep.studies import compose
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain, Parts
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.models import FORCE, POSITION
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.schemes.mkf import SCHEME
from owtsweep.studies.hub.schemes.multirate import MultirateKalmanFilter
from owtsweep.studies.hub.sensors import Sensors

AGREEMENT = 1e-8


@dataclass(frozen=True)
class Job:
    """One record and the filter to run on it.

    `force` is the specific force in NED (m/s^2), shape (steps, 2); `fixes` are position fixes (m),
    shape (fixes, 2).
    """

    chain: Chain
    sensors: Sensors
    force: np.ndarray
    fixes: np.ndarray

    @property
    def steps(self) -> int:
        return len(self.force)


def make_job(seconds_of_record: float) -> Job:
    """Make the job from the first record of the default study, for MKF with tuning=matched."""
    config: Any = compose([STUDY[0], "tuning=matched", f"record.duration={seconds_of_record}"])
    records = make_records(config, 4.0, [0])
    chain = SCHEME.kernel(Known(records.sensors, config), records.steps)
    force, fixes = records.measure(0.5)
    return Job(chain, records.sensors, force, fixes)


def measure(duration: float = 40.0, repeats: int = REPEATS) -> list[dict[str, object]]:
    """Measure all peers; return one row per peer.

    Each row has ns per IMU step of the two-axis record, whether the states agree with those of
    owtsweep, and a note. Both are None for a peer that is not installed.
    """
    job = make_job(duration)
    ours = batched(job)()
    rows = []
    for name, note, make in PEERS:
        try:
            work = make(job)
        except ImportError as error:
            rows.append({"peer": name, "ns": None, "agrees": None, "note": f"skipped: {error}"})
            continue
        answer = work()
        difference = np.max(np.abs(answer - ours), axis=0) / np.max(np.abs(ours), axis=0)
        agrees = bool(np.all(difference <= AGREEMENT))
        rows.append(
            {
                "peer": name,
                "ns": 1e9 * seconds(work, repeats=repeats) / job.steps,
                "agrees": agrees,
                "note": note,
            }
        )
    return rows


def batched(job: Job) -> Callable[[], np.ndarray]:
    """Make the function that runs owtsweep's batch engine on the record.

    The function returns the states x, y, v_x, v_y, a_x, ... at every step, shape (steps, 8).
    """
    return lambda: estimates.states(job.chain, job.force, job.fixes).reshape(job.steps, 8)


def _numpy(job: Job) -> Callable[[], np.ndarray]:
    def work() -> np.ndarray:
        F, Q, P = _model(job)
        H_fix, H_force = np.kron(POSITION, np.eye(2)), np.kron(FORCE, np.eye(2))
        H = {True: np.vstack([H_fix, H_force]), False: H_force}
        r = [job.chain.axis.position_variance] * 2 + [job.chain.axis.force_variance] * 2
        R = {True: np.diag(r), False: np.diag(r[2:])}
        x, out, identity = np.zeros(8), np.empty((job.steps, 8)), np.eye(8)
        for k, z, has_fix in _measurements(job):
            x, P = F @ x, F @ P @ F.T + Q
            S = H[has_fix] @ P @ H[has_fix].T + R[has_fix]
            K = np.linalg.solve(S, H[has_fix] @ P).T
            x = x + K @ (z - H[has_fix] @ x)
            P = (identity - K @ H[has_fix]) @ P
            out[k] = x
        return out

    return work


def _filterpy(job: Job) -> Callable[[], np.ndarray]:
    import filterpy  # noqa: F401

    def work() -> np.ndarray:
        kf = MultirateKalmanFilter(Parts(job.chain.axis, "proper"), np.eye(2))
        out = np.empty((job.steps, 8))
        for k, z, has_fix in _measurements(job):
            out[k] = kf.step(z[-2:], z[:2] if has_fix else None).x
        return out

    return work


def _statsmodels(job: Job) -> Callable[[], np.ndarray]:
    from statsmodels.tsa.statespace.kalman_filter import KalmanFilter

    F, Q, P = _model(job)
    axis = job.chain.axis
    kf = KalmanFilter(k_endog=4, k_states=8)
    kf["design"] = np.vstack([np.kron(POSITION, np.eye(2)), np.kron(FORCE, np.eye(2))])
    kf["obs_cov"] = np.diag([axis.position_variance] * 2 + [axis.force_variance] * 2)
    kf["transition"], kf["selection"], kf["state_cov"] = F, np.eye(8), Q
    kf.initialize_known(np.zeros(8), F @ P @ F.T + Q)
    endog = np.full((job.steps, 4), np.nan)
    endog[:: job.sensors.fix_interval, :2] = job.fixes
    endog[:, 2:] = job.force
    kf.bind(endog)
    return lambda: np.asarray(kf.filter().filtered_state).T


def _model(job: Job) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the matrices F, Q and P_0 of the model on two axes, shape (8, 8) each.

    They are the transition matrix, the process noise and the initial covariance.
    """
    axis = job.chain.axis
    identity = np.eye(2)
    F, Q = np.kron(axis.model.A, identity), np.kron(axis.model.Q, identity)
    return F, Q, np.kron(axis.initial_covariance, identity)


def _measurements(job: Job) -> Iterator[tuple[int, np.ndarray, bool]]:
    """Yield for every step: its number, the measurement, and whether a fix is part of it.

    The measurement is the specific force, after the position fix if there is one.
    """
    M = job.sensors.fix_interval
    for k, force in enumerate(job.force):
        has_fix = k % M == 0
        yield k, np.concatenate([job.fixes[k // M], force]) if has_fix else force, has_fix


#: Name, note, and function that makes the work to measure from a job. It raises ImportError if the
#: peer is not installed.
PEERS: tuple[tuple[str, str, Callable[[Job], Callable[[], np.ndarray]]], ...] = (
    ("owtsweep batch, this record alone", "one record: 2 lanes, no states kept but these", batched),
    ("NumPy loop", "8 x 8 matrices, gains computed at every step", _numpy),
    ("filterpy", "predict and update (Joseph form), one object", _filterpy),
    ("statsmodels", "compiled, exact for partly missing measurements", _statsmodels),
)


if __name__ == "__main__":
    for row in measure():
        print(row)
