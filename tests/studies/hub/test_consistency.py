"""Are the estimators as good as they say, and as good as anything can be?

With `matched` tuning the covariances are true, so NEES must follow its chi-square law, and HME1
must reach the Kalman bound for Sigma_2 with nothing assumed about the motion. The records are the
default sensors' at 100 Hz and a natural period of 4 s.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats
from tools import Array

from owtsweep.streams import stream
from owtsweep.studies import compose
from owtsweep.studies.hub import estimates, measures
from owtsweep.studies.hub.batch import sum_errors
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import STUDY, Records, make_records

pytestmark = pytest.mark.usefixtures("kernels")

PERIOD = 4.0
REPLICATES = range(12)
#: Some 60 s between samples, four times the bias' time constant, sqrt(density of the
#: accelerometer's noise / density of the bias walk) = 15 s; prime, so that it meets all phases.
SPACING = 6007


@cache
def setting(delay: float) -> tuple[HubConfig, Records]:
    config = compose(
        ["experiment=study", "tuning=matched", "record.duration=1200",
         f"sensors.gnss.delay={delay}", "sensors.yaw=37", "sensors.gravity=[0.05,-0.03]"]
    )  # fmt: skip
    assert isinstance(config, HubConfig)
    return config, make_records(config, PERIOD, REPLICATES)


def true_x4(config: HubConfig, records: Records) -> Array:
    """x4 = -R b + g of every lane, (steps, lanes), from the streams that the sensors draw on."""
    imu, sensors = config.sensors.imu, records.sensors
    lanes = []
    for replicate in records.replicates:
        drawn = [
            stream(config.seed, STUDY, (PERIOD,), replicate, f"bias_{axis}").standard_normal(
                records.steps
            )
            for axis in "xy"
        ]
        walk = imu.bias_walk * np.sqrt(sensors.step) * np.array(drawn)
        walk[:, 0] = imu.bias_initial
        lanes.append(np.array(sensors.gravity) - np.cumsum(walk, axis=1).T @ sensors.rotation.T)
    return np.concatenate(lanes, axis=1)


def sampled_nees(chain: Chain, config: HubConfig, records: Records, amplitude: float) -> Array:
    """NEES of one axis' (p, v, b), all lanes, at every SPACING-th step but the first."""
    force, fixes = records.measure(amplitude)
    positions, velocities = (
        np.array([getattr(m, name) for m in records.motion]) for name in ("position", "velocity")
    )
    delay = chain.filter.input_delay  # the filter's state belongs to the delayed time
    direction = np.tile(records.direction, len(records.replicates))
    x4 = true_x4(config, records)
    unsmoothed = replace(chain, filter=chain.filter._replace(window=0))
    states = estimates.states(unsmoothed, force, fixes)
    nees = []
    for k0 in range(0, records.steps - SPACING, SPACING):
        k = k0 + SPACING - 1
        at = k - delay
        truth = np.array(
            [
                amplitude * np.repeat(positions[:, at], 2) * direction,
                amplitude * np.repeat(velocities[:, at], 2) * direction,
                x4[at],
            ]
        )
        error = states[k, [0, 1, 3]] - truth
        P = chain.gains.filtered[chain.gains.row(k)][np.ix_([0, 1, 3], [0, 1, 3])]
        if k0 > 0:  # the first 60 s are the transient
            nees.append(np.sum(error * np.linalg.solve(P, error), axis=0))
    return np.concatenate(nees)


@pytest.mark.parametrize("amplitude", [0.0, 0.2])
@pytest.mark.parametrize(("name", "delay"), [("HME1", 0.2), ("MKF", 0.0)])
def test_nees_of_the_filter_is_chi_square(name: str, delay: float, amplitude: float) -> None:
    config, records = setting(delay)
    chain = resolve(name).kernel(Known(records.sensors, config), records.steps)
    assert chain.filter.input_delay == round(delay * 100)
    nees = sampled_nees(chain, config, records, amplitude)
    assert len(nees) == 18 * 2 * len(REPLICATES)
    # the sum of N independent values has 3 N degrees of freedom: 99 % two-sided, here +- 10 %
    low, high = stats.chi2.interval(0.99, 3 * len(nees))
    assert low / len(nees) < np.mean(nees) < high / len(nees)


def kalman_bound(
    fix_sigma: float, force_density: float, walk_density: float, delay: float
) -> float:
    """Variance of the present position (m^2, one axis) with nothing assumed about the motion.

    The accelerometer's noise is the input's; fixes come every second; the estimate is carried on
    over the phases of the interval and the delay. All matrices by hand.
    """

    def over(t: float) -> tuple[Array, Array]:
        A = np.array([[1.0, t, t**2 / 2], [0.0, 1.0, t], [0.0, 0.0, 1.0]])
        force = np.array([[t**3 / 3, t**2 / 2, 0.0], [t**2 / 2, t, 0.0], [0.0, 0.0, 0.0]])
        walk = np.array(
            [
                [t**5 / 20, t**4 / 8, t**3 / 6],
                [t**4 / 8, t**3 / 3, t**2 / 2],
                [t**3 / 6, t**2 / 2, t],
            ]
        )
        return A, force_density * force + walk_density * walk

    A, Q = over(1.0)
    P = np.eye(3)
    for _ in range(2000):
        M = A @ P @ A.T + Q
        K = M[:, 0] / (M[0, 0] + fix_sigma**2)
        P = M - np.outer(K, M[0])
    variances = []
    for phase in range(100):
        A, Q = over(phase * 0.01 + delay)
        variances.append((A @ P @ A.T + Q)[0, 0])
    return float(np.mean(variances))


def test_the_bound_of_the_default_sensors() -> None:
    bound = kalman_bound(0.03, 0.15**2 * 0.01, 1e-3**2, 0.2)
    assert bound == pytest.approx(1.295e-3, rel=1e-3)


@cache
def settled_hme1() -> dict[str, tuple[float, float, float]]:
    """Products of HME1's settled measures, averaged over the replicates."""
    config, records = setting(0.2)
    chain = resolve("HME1").kernel(Known(records.sensors, config), records.steps)
    (sums,) = sum_errors([chain], records, settled=6000)
    found = measures.from_sums(sums)
    means = np.mean([of_record.products for of_record in found], axis=0)
    labels = zip(found[0].measures, found[0].windows, strict=True)
    return {
        name: tuple(products)
        for (name, window), products in zip(labels, means, strict=True)
        if window == "settled"
    }


@pytest.mark.parametrize("amplitude", [0.2, 1.0])
def test_hme1_reaches_the_kalman_bound(amplitude: float) -> None:
    motion, cross, noise = settled_hme1()["position"]
    mse = amplitude**2 * motion + 2 * amplitude * cross + noise
    bound = kalman_bound(0.03, 0.15**2 * 0.01, 1e-3**2, 0.2)
    assert mse == pytest.approx(2 * bound, rel=0.05)


@pytest.mark.parametrize("amplitude", [0.0, 0.2])
def test_hme1_reports_its_own_accuracy(amplitude: float) -> None:
    motion, cross, noise = settled_hme1()["nees"]
    assert amplitude**2 * motion + 2 * amplitude * cross + noise == pytest.approx(4.0, rel=0.04)
