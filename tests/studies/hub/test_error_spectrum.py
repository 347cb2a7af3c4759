"""Error spectra and noise floors against simulation, covariance and each other."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure

from owtsweep.errors import InputError
from owtsweep.studies.hub import batch, estimates, settled
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.error_spectrum import ErrorSpectrum, error_spectrum, expected_mse
from owtsweep.studies.hub.noise_floor import noise_floor
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import Sensors

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


#: A bias gain that lets records of some 2000 s settle, whatever tuning=paper comes to be.
QUICK = tuple(f"{scheme}.q_b=1e-6" for scheme in ("ekf", "mkf", "hme1", "hme2"))


def chain_of(name: str, config: HubConfig) -> tuple[Chain, Sensors]:
    sensors = sensing.sensors(config.sensors)
    return resolve(name).kernel(Known(sensors, config)), sensors


def simulated(
    chain: Chain, sensors: Sensors, frequency: float, *, seconds: float, last: float
) -> tuple[float, float]:
    """Mean square errors over mean square of a sinusoid, from its cosine and its sine."""
    omega = 2 * np.pi * frequency
    time = sensors.step * np.arange(round(seconds / sensors.step))
    fix_time = time[:: sensors.fix_interval] - sensors.delay * sensors.step
    phases = np.array([0.0, np.pi / 2])
    truth = np.cos(omega * time[:, None] - phases)
    position, velocity, _ = estimates.trajectories(
        chain, -(omega**2) * truth, np.cos(omega * fix_time[:, None] - phases)
    )
    rate = -omega * np.sin(omega * time[:, None] - phases)
    part = slice(-round(last / sensors.step), None)
    return (
        float(np.mean((position - truth)[part] ** 2) / 0.5),
        float(np.mean((velocity - rate)[part] ** 2) / 0.5),
    )


@pytest.mark.parametrize("tuning", ["paper", "matched"])
@pytest.mark.parametrize("name", SCHEMES)
def test_one_sinusoid_simulated(name: str, tuning: str) -> None:
    # .37 Hz repeats with 2 Hz fixes every 100 s, so the last 100 s hold whole periods of both
    chain, sensors = chain_of(name, configure("sensors.gnss.delay=0.2", *QUICK, tuning=tuning))
    spectrum = error_spectrum(chain, sensors, np.array([0.1, 0.37]))
    expected = simulated(chain, sensors, 0.37, seconds=3000, last=100)
    assert spectrum.position[1] == pytest.approx(expected[0], rel=2e-3)
    assert spectrum.velocity[1] == pytest.approx(expected[1], rel=2e-3)


def test_the_extrapolated_response_is_the_one_that_a_long_run_reaches() -> None:
    chain, sensors = chain_of("HME2", configure())
    frequency = np.array([0.05, 0.31, 0.6])
    soon = error_spectrum(chain, sensors, frequency, settle=20)
    late = error_spectrum(chain, sensors, frequency, settle=2000)
    np.testing.assert_allclose(soon.position, late.position, rtol=1e-6)
    np.testing.assert_allclose(soon.velocity, late.velocity, rtol=1e-6)


def test_ekf_is_mkf_when_matched() -> None:
    config = configure(tuning="matched")
    frequency = np.geomspace(0.05, 0.9, 20)
    ekf, mkf = (error_spectrum(*chain_of(name, config), frequency) for name in ("EKF", "MKF"))
    np.testing.assert_allclose(ekf.position, mkf.position, rtol=1e-9)
    assert noise_floor(*chain_of("EKF", config)).of("position") == pytest.approx(
        noise_floor(*chain_of("MKF", config)).of("position"), rel=1e-9
    )


@pytest.mark.parametrize("name", ["MKF", "HME1", "HME2"])
def test_the_integral_over_a_spectrum_is_what_records_show(name: str) -> None:
    config = configure("normalise=rms", "record.duration=900", "measures.settling_time=300", *QUICK)
    records = make_records(config, 4.0, range(8))
    chain, sensors = chain_of(name, config)
    settling = round(config.measures.settling_time / sensors.step)
    (sums,) = batch.sum_errors([chain], records, settling)
    motion = sums.products[1, :4, 0].mean(axis=-1) / sums.steps[1]
    band = (config.band[0], config.band[1])
    errors = error_spectrum(chain, sensors, np.geomspace(*band, 60))
    shape = config.spectrum.at(4.0)
    position, velocity = expected_mse(errors, shape.density, band)
    assert position == pytest.approx(motion[0] + motion[1], rel=0.06)
    assert velocity == pytest.approx(motion[2] + motion[3], rel=0.06)
    assert expected_mse(errors, shape.density, band, rms=3.0)[0] == pytest.approx(9 * position)


@pytest.mark.parametrize("tuning", ["paper", "matched"])
def test_the_noise_floor_is_what_records_without_motion_show(tuning: str) -> None:
    changes = ("record.duration=2400", "measures.settling_time=600", *QUICK)
    config = configure(*changes, tuning=tuning)
    records = make_records(config, 4.0, range(8))
    for name in SCHEMES:
        chain, sensors = chain_of(name, config)
        (sums,) = batch.sum_errors([chain], records, 12000)
        per_record = sums.products[1, :4, 2] / sums.steps[1]
        floor = noise_floor(chain, sensors)
        for measure, parts in (("position", per_record[:2]), ("velocity", per_record[2:])):
            values = parts.sum(axis=0)
            margin = 4.0 * np.std(values, ddof=1) / np.sqrt(len(values))
            assert margin < 0.35 * values.mean(), (name, measure)
            assert abs(floor.of(measure) - values.mean()) < margin, (name, measure)


@pytest.mark.parametrize("walk", [1e-3, 1e-2])
def test_the_noise_floor_of_an_exact_filter_is_its_covariance(walk: float) -> None:
    changes = ("mkf.model=sigma2", f"sensors.imu.bias_walk={walk}", "sensors.gnss.delay=0")
    chain, sensors = chain_of("MKF", configure(*changes, tuning="matched"))
    floor = noise_floor(chain, sensors)
    cycle = chain.gains.filtered[-chain.gains.cycle :]
    # the model's noise is continuous, the samples' is held over a step: a part of some T/T_g
    assert floor.of("position") == pytest.approx(2 * cycle[:, 0, 0].mean(), rel=0.02)
    assert floor.of("velocity") == pytest.approx(2 * cycle[:, 1, 1].mean(), rel=0.02)
    assert set(floor.position) == {"gnss", "imu", "bias"}
    assert min(floor.position.values()) > 0


def test_each_noise_has_its_own_part() -> None:
    changed = {"gnss.sigma": "gnss", "imu.sigma": "imu", "imu.bias_walk": "bias"}
    config = configure(*QUICK, tuning="paper")
    for key, source in changed.items():
        section, name = key.split(".")
        old = getattr(getattr(config.sensors, section), name)
        # the scheme goes on with its own tuning: only the truth is doubled
        chain, sensors = chain_of("HME1", config)
        louder = sensing.sensors(configure(f"sensors.{key}={2 * old}").sensors)
        before, after = noise_floor(chain, sensors).position, noise_floor(chain, louder).position
        for part, value in before.items():
            factor = 4.0 if part == source else 1.0
            assert after[part] == pytest.approx(factor * value, rel=1e-9), (key, part)


def test_limits_of_sequences_with_slow_and_turning_modes() -> None:
    rng = np.random.default_rng(5)
    modes = np.array([0.999, 0.97 * np.exp(0.4j), 0.97 * np.exp(-0.4j), 0.5])
    modes = modes * np.exp(-1.1j)
    goal, starts = rng.normal(size=(30, 2)), rng.normal(size=(len(modes), 30, 2))
    terms = np.array([goal + np.tensordot(modes**n, starts, 1) for n in range(10)])
    settled_value, remainder = settled.limit(terms)
    np.testing.assert_allclose(settled_value, goal, atol=1e-8)
    assert np.all(remainder < 1e-9)
    settled_value, remainder = settled.limit(terms + rng.normal(scale=0.1, size=terms.shape))
    assert np.all(remainder > 1e-3)


def test_refusals() -> None:
    chain, sensors = chain_of("HME1", configure())
    with pytest.raises(InputError, match=r"^frequencies: 2 Hz is a multiple of the rate"):
        error_spectrum(chain, sensors, np.array([0.2, 2.0]))
    with pytest.raises(InputError, match=r"^frequencies: give a list of positive"):
        error_spectrum(chain, sensors, np.array([0.3, 0.2]))
    flat = ErrorSpectrum(np.array([0.1, 0.5]), np.ones(2), np.ones(2))
    with pytest.raises(InputError, match=r"^band: \[0.05, 0.5\] Hz reaches beyond the error"):
        expected_mse(flat, np.ones_like, (0.05, 0.5))
    assert expected_mse(flat, np.ones_like, (0.1, 0.5), rms=2.0) == pytest.approx((4.0, 4.0))


def test_a_floor_that_never_settles_is_refused() -> None:
    # a bias that the filter takes for constant: its gain is all but gone when the schedule ends
    config = configure("hme1.q_b=1e-16", "hme1.p0=[1,1,1,1e-9]")
    chain, sensors = chain_of("HME1", config)
    with pytest.raises(InputError, match=r"^chain: the response to noise has not died out"):
        noise_floor(chain, sensors)
