"""The schemes of the tower study: one contract, exact cases, and reasons for which they refuse."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from settings import CUT, SPARSE, STRAIN, make_setting, place
from turbine import STEP, make, streams

from owtsweep.errors import InputError
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.tower.measuring import add_errors, take_signals
from owtsweep.studies.tower.models import model_cut, respond_statically
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.schemes.filtered import list_unseen_rigid
from owtsweep.studies.tower.sections import Faults

ABLE = [name for name in SCHEMES.listed if name != "DUAL"]


@cache
def record():
    """Return truth, setting and measurements of 60 s with 1 % noise."""
    motion = make(steps=6000, gravity=False)["fa"]
    places = place(SPARSE)
    signals = take_signals(motion, STRAIN, places, Faults())
    sigma = 0.01 * signals.std(axis=0)
    names = [f"{kind}_{node}" for kind, node, _ in places]
    measured = add_errors(signals, sigma, Faults(), streams(), names, STEP)
    return motion, make_setting(SPARSE, sigma), measured


@cache
def prepared(name):
    return SCHEMES.resolve(name).prepare(record()[1])


@pytest.mark.parametrize("name", ABLE)
def test_every_scheme_keeps_the_contract(name):
    motion, _, measured = record()
    scheme = SCHEMES.resolve(name)
    assert scheme.name == name
    knowing = {"AKF_WHOLE", "AKF_WHOLE_WAVE", "KF_WHOLE", "MDE", "THRUST_LEVER"}
    assert bool(scheme.ignores) == (name not in knowing)
    kept = measured.copy()
    estimates = prepared(name).run(measured)
    assert np.array_equal(measured, kept)
    assert estimates.displacement.shape == motion.displacement.shape
    assert estimates.inputs.shape == motion.inputs.shape
    assert (estimates.wave is not None) == name.endswith("_WAVE")
    if estimates.wave is not None:
        assert estimates.wave.shape == motion.wave.shape
    for array in (estimates.displacement, estimates.inputs):
        assert array.dtype == np.float64
        assert np.all(np.isfinite(array))


@pytest.mark.parametrize("name", ABLE)
def test_a_scheme_looks_ahead_by_its_latency_and_no_farther(name):
    measured = record()[2][:600]
    later = measured.copy()
    later[400:] += 1.0
    one, other = prepared(name).run(measured), prepared(name).run(later)
    steps = round(one.latency / STEP)
    assert steps == {"AKF_LAGGED": 30, "MDE": 600}.get(name, 0)
    changed = np.flatnonzero(np.any(one.displacement != other.displacement, axis=1))
    assert changed[0] == max(400 - steps, 0)


@pytest.mark.parametrize("name", ABLE)
def test_estimates_of_a_sum_are_the_sum_of_estimates(name):
    measured = record()[2][:600]
    other = np.random.default_rng(3).standard_normal(measured.shape) * measured.std(axis=0)
    run = prepared(name).run
    both, one, two = run(measured - 2.0 * other), run(measured), run(other)
    for field in ("displacement", "inputs"):
        expected = getattr(one, field) - 2.0 * getattr(two, field)
        size = np.abs(expected).max(axis=0)
        # the prior of 1e6 costs digits in the first steps
        assert np.all(np.abs(getattr(both, field) - expected) <= 1e-7 * size)


@pytest.mark.parametrize("name", ABLE)
def test_a_steady_thrust_is_recovered(name):
    # noise-free, and exact for every scheme: nothing moves, the thrust acts at the lever's end
    thrust, offset, length = 1.3e6, 4.4, 175.0
    setting = record()[1]
    force = np.zeros((len(CUT.mass), 1))
    force[-2:, 0] = thrust, thrust * offset
    shape = respond_statically(setting.whole, force)[:, 0]
    reading = [0.0 if c.kind == "a" else shape[2 * c.node + 1] for c in setting.channels]
    estimates = SCHEMES.resolve(name).prepare(setting).run(np.tile(reading, (3000, 1)))
    loads = np.array([-thrust, -thrust * (length + offset), thrust, thrust * offset])
    assert np.allclose(estimates.inputs[-1, [0, 2]], loads[[0, 2]], rtol=0.01)
    assert np.allclose(estimates.inputs[-1, [1, 3]], loads[[1, 3]], atol=0.003 * abs(loads[1]))
    strain = STRAIN @ shape
    assert np.allclose(STRAIN @ estimates.displacement[-1], strain, atol=0.003 * np.ptp(strain))


@pytest.mark.parametrize("name", ["AKF", "AKF_WAVE", "GDF", "AKF_WHOLE", "KF_WHOLE", "MDE"])
def test_moments_and_strains_follow_the_truth(name):
    motion, _, measured = record()
    estimates = prepared(name).run(measured)
    late = slice(1000, None)
    strain, expected = estimates.displacement @ STRAIN.T, motion.displacement @ STRAIN.T
    error = (strain - expected)[late].std(axis=0) / expected[late].std(axis=0)
    assert error[0] < 0.15
    moment = motion.inputs[late, 1]
    assert np.std(estimates.inputs[late, 1] - moment) < 0.15 * np.std(moment)


@pytest.mark.parametrize(("name", "bound"), [("GDF", 1e-8), ("AKF", 1e-3), ("AKF_LAGGED", 1e-4)])
def test_a_record_of_the_exact_model_without_noise_is_recovered(name, bound):
    # loads and motion of the model itself; GDF believes nothing of loads, so it is exact
    heights = {"x": (0, 58, 110, 175), "a": (0, 35, 84, 136, 175)}
    sigma = np.repeat([1e-5, 1e-4], [4, 5])
    setting = make_setting(heights, sigma)
    model = model_cut(setting)
    discrete, steps = model.discrete, 1500
    time = STEP * np.arange(steps)[:, None]
    loads = np.array([1e5, 1e7, 1e5, 1e7]) * np.sin(time * [0.7, 1.1, 0.5, 0.9] + np.arange(4.0))
    inputs = loads / model.scale
    states = np.zeros((steps, 2 * model.modes))
    for k in range(steps - 1):
        states[k + 1] = discrete.A @ states[k] + discrete.B @ inputs[k]
    measured = states @ discrete.G.T + inputs @ discrete.J.T
    tuning = setting.tuning.model_copy(update={"process_noise": 1e-9})
    exact = replace(setting, tuning=tuning, rate_noise=1e-9)
    estimates = SCHEMES.resolve(name).prepare(exact).run(measured)
    late = slice(500, -100)
    assert np.all(np.abs(estimates.inputs - loads)[late].max(axis=0) < bound * loads.max(axis=0))
    moved = states[:, : model.modes] @ model.basis.T
    error = np.abs(estimates.displacement - moved)[late].max(axis=0)
    assert np.all(error <= bound * np.abs(moved).max(axis=0))


def test_accelerometers_alone_are_blind_to_static_loads():
    # four directions are rigid motion; two balanced static loads cause no acceleration
    blind = make_setting({"a": (0, 35, 40, 84, 175)}, 1e-4)
    for name in ("AKF", "GDF"):
        with pytest.raises(Unable, match=rf"{name} is blind: .* 14 of 20 .* 2 of the others"):
            SCHEMES.resolve(name).prepare(blind)
    with pytest.raises(Unable, match=r"AKF_WHOLE is blind: .* 20 of 22 .* 2 of the others"):
        SCHEMES.resolve("AKF_WHOLE").prepare(blind)
    with pytest.raises(Unable, match=r"QUASI_STATIC is blind: .* see 0 of 3 static shapes"):
        SCHEMES.resolve("QUASI_STATIC").prepare(blind)
    with pytest.raises(Unable, match="THRUST_LEVER is blind: it needs an inclinometer"):
        SCHEMES.resolve("THRUST_LEVER").prepare(blind)
    for name in ("KF_WHOLE", "MDE"):
        SCHEMES.resolve(name).prepare(blind)


def test_three_inclinometers_do_not_tell_waves_from_loads_at_the_cuts():
    # static: rotation, two balanced loads and the wave are four unknowns
    setting = make_setting({**SPARSE, "theta": (0, 84, 175)}, record_sigma(3))
    SCHEMES.resolve("AKF").prepare(setting)
    with pytest.raises(Unable, match=r"AKF_WAVE is blind: .* 18 of 21 .* 1 of the others"):
        SCHEMES.resolve("AKF_WAVE").prepare(setting)


def record_sigma(inclinometers):
    sigma = np.array([channel.sigma for channel in record()[1].channels])
    return np.concatenate([sigma[:inclinometers], sigma[5:]])


def test_a_translation_that_drifts_makes_no_scheme_unable():
    setting = record()[1]
    filtered = prepared("AKF")
    assert list_unseen_rigid(setting, filtered.model) == [0, filtered.model.modes]
    radius = np.abs(np.linalg.eigvals(filtered.filter.F)).max()
    assert radius == pytest.approx(1.0, abs=1e-6)
    positioned = make_setting({"x": (175,), **SPARSE}, np.append(0.01, record_sigma(5)))
    assert list_unseen_rigid(positioned, SCHEMES.resolve("AKF").prepare(positioned).model) == []


def test_the_dual_filter_says_its_spectral_radius():
    with pytest.raises(
        Unable, match=r"DUAL .*: the spectral radius of its closed loop is (1|above)"
    ):
        SCHEMES.resolve("DUAL").prepare(record()[1])


def test_too_few_accelerometers_or_no_water_are_reasons():
    setting = make_setting({"theta": SPARSE["theta"], "a": (175,)}, 1e-5)
    with pytest.raises(Unable, match="GDF is blind: the feedthrough matrix J has rank 1, but 4"):
        SCHEMES.resolve("GDF").prepare(setting)
    dry = replace(record()[1], wave_shape=0.0 * record()[1].wave_shape)
    for name in ("AKF_WAVE", "AKF_WHOLE_WAVE"):
        with pytest.raises(Unable, match=f"{name} has no wave load to estimate"):
            SCHEMES.resolve(name).prepare(dry)
    with pytest.raises(Unable, match="MDE is blind to dynamics: it needs an accelerometer"):
        SCHEMES.resolve("MDE").prepare(make_setting({"theta": SPARSE["theta"]}, 1e-5))


def test_unknown_and_repeated_names_are_refused():
    with pytest.raises(InputError, match=r"no scheme 'EKF' here .*; use AKF, "):
        SCHEMES.resolve("EKF")
    with pytest.raises(InputError, match="'AKF' stands there twice"):
        SCHEMES.resolve_all(["AKF", "AKF"])
    with pytest.raises(InputError, match="the list is empty"):
        SCHEMES.resolve_all([])
    assert [scheme.name for scheme in SCHEMES.resolve_all(["MDE", "AKF"])] == ["MDE", "AKF"]
