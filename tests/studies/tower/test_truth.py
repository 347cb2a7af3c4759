"""The truth of the tower study: loads, balance of forces, measurements."""

import numpy as np
import pandas as pd
import pytest
from turbine import CALM, CUTS, ROUGH, STEP, STRUCTURE, WIND, make, streams

from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Span
from owtsweep.structures.bernoulli import assemble_cut, strain_matrix
from owtsweep.studies.tower.measuring import Place, add_errors, take_signals
from owtsweep.studies.tower.sections import Faults
from owtsweep.studies.tower.waves import make_wave_loads, triangular_load
from owtsweep.studies.tower.wind import find_spectrum, make_top_loads


@pytest.fixture(scope="module", params=[CALM, ROUGH], ids=["calm", "rough"])
def truth(request):
    return make(sea=request.param)


def test_the_soil_holds_what_goes_through_the_lower_cut(truth):
    # two ways to the same forces: balance of the cut structure, and the springs' own law
    springs = STRUCTURE.foundation.matrix()
    for motion in truth.values():
        reaction = -motion.displacement[:, :2] @ springs
        error = np.abs(motion.inputs[:, :2] - reaction).max(axis=0)
        assert np.all(error <= 1e-6 * reaction.std(axis=0))


def test_the_neighbour_above_obeys_newton():
    # thrust and moment minus inertia, weight and damper of the rotor-nacelle
    motion = make()["fa"]
    body = STRUCTURE.points[0]
    top = make_top_loads(WIND, streams(), steps=4000, step=STEP)
    push, spin = motion.acceleration[:, 38], motion.acceleration[:, 39]
    speed = np.gradient(motion.displacement[:, 38], STEP)
    force = top[:, 0] - body.mass * (push + body.offset * spin) - WIND.damping * speed
    moment = (
        top[:, 1]
        - body.mass * body.offset * push
        - (body.inertia + body.mass * body.offset**2) * spin
        + body.mass * STRUCTURE.gravity * body.offset * motion.displacement[:, 39]
    )
    inner = slice(5, -5)
    np.testing.assert_allclose(motion.inputs[inner, 2], force[inner], rtol=1e-5)
    np.testing.assert_allclose(motion.inputs[inner, 3], moment[inner], rtol=1e-6)


def test_accelerations_are_derivatives_of_displacements(truth):
    for motion in truth.values():
        second = np.diff(motion.displacement, 2, axis=0) / STEP**2
        error = (second - motion.acceleration[1:-1])[:, ::2].std(axis=0)
        assert np.all(error <= 0.005 * motion.acceleration[:, ::2].std(axis=0))


def test_weight_leans_on_the_structure():
    heavy, light = (make(gravity=g)["fa"].displacement[:, 38].mean() for g in (True, False))
    assert heavy == pytest.approx(1.07 * light, rel=0.01)


def test_a_finer_mesh_tells_the_same():
    coarse = make(subdivision=1)["fa"]
    fine = make(subdivision=2)["fa"]
    scale = fine.displacement.std(axis=0)
    assert np.all((coarse.displacement - fine.displacement).std(axis=0) <= 1e-3 * scale)


def test_the_loads_have_the_declared_statistics():
    loads = np.concatenate(
        [make_top_loads(WIND, streams(r), steps=20000, step=0.1) for r in range(10)]
    )
    np.testing.assert_allclose(loads[:, 0].mean(), 1.3e6, rtol=0.01)
    np.testing.assert_allclose(loads.std(axis=0), [1.3e5, 5e6, 1.2e4, 1.2e6], rtol=0.05)


def test_the_lines_have_their_shares_of_the_variance():
    frequency = np.arange(1, 70000) / 1400.0
    spectrum = find_spectrum(WIND, frequency)
    assert spectrum.sum() == pytest.approx(1.0)
    for blades, share in ((1, WIND.line_1p), (3, WIND.line_3p)):
        near = np.abs(frequency / (blades * WIND.rotor_speed) - 1.0) < 0.1
        assert spectrum[near].sum() == pytest.approx(share, rel=0.15)


def test_wave_loads_do_their_work_on_rigid_motion():
    # the resultant, and the moment about the ground, whatever the mesh
    totals = []
    for subdivision in (1, 3):
        beam = assemble_cut(STRUCTURE, *CUTS, subdivision=subdivision)
        waves = make_wave_loads(STRUCTURE, beam, ROUGH, streams(), Span(3000, 0.1))
        shift, lean = np.zeros((2, len(beam.mass)))
        shift[0::2] = 1.0
        lean[0::2], lean[1::2] = beam.heights + 30.0, 1.0
        np.testing.assert_allclose(waves.series @ shift[waves.dof], waves.force, rtol=1e-9)
        totals.append(waves.series @ lean[waves.dof])
    np.testing.assert_allclose(totals[0], totals[1], rtol=1e-9)


def test_the_triangle_has_half_the_depth_as_resultant():
    beam = assemble_cut(STRUCTURE, *CUTS)
    triangle = triangular_load(STRUCTURE, beam)
    assert triangle[0::2].sum() == pytest.approx(15.0)
    arm = triangle[0::2] @ (beam.heights + 30.0) + triangle[1::2].sum()
    assert arm == pytest.approx(15.0 * 20.0)  # two thirds of the depth


def test_sensors_read_the_truth_and_their_faults():
    motion = make()["fa"]
    beam = assemble_cut(STRUCTURE, *CUTS)
    strain = strain_matrix(STRUCTURE, beam)
    channels = [Place("x", 3), Place("theta", 19), Place("a", 19), Place("strain", 5)]
    plain = take_signals(motion, strain, channels, Faults())
    turn, push = motion.displacement[:, 39], motion.acceleration[:, 38]
    np.testing.assert_array_equal(plain[:, 1], turn)
    np.testing.assert_allclose(plain[:, 3], motion.displacement @ strain[5])
    both = Faults(tilted_accelerometers=True, accelerated_inclinometers=True)
    felt = take_signals(motion, strain, channels, both)
    np.testing.assert_allclose(felt[:, 1], turn - push / GRAVITY)
    np.testing.assert_allclose(felt[:, 2], push - GRAVITY * turn)


def test_a_larger_noise_is_the_same_noise_enlarged():
    signals = np.random.default_rng(1).normal(size=(500, 2))
    names = ["x_000", "a_175"]
    one, three = (
        add_errors(signals, size * np.ones(2), Faults(), streams(), names, STEP) - signals
        for size in (1.0, 3.0)
    )
    np.testing.assert_allclose(three, 3.0 * one, atol=1e-12)


def test_lost_samples_repeat_the_last_one():
    signals = np.arange(2000.0)[:, None]
    faults = Faults(loss=0.01, loss_length=5)
    got = add_errors(signals, np.zeros(1), faults, streams(), ["x_000"], STEP)[:, 0]
    lost = got != signals[:, 0]
    assert 0.02 < lost.mean() < 0.08
    assert np.all(np.diff(got) >= 0.0)


def test_recorded_loads_come_from_their_file(tmp_path):
    time = np.arange(0.0, 60.0, 0.5)
    table = pd.DataFrame({"time": time + 7.0, "thrust": 1e6 + 1e4 * time, "moment": -1e7,
                          "side": 0.0, "side_moment": 0.0})  # fmt: skip
    file = tmp_path / "top.csv"
    table.to_csv(file, index=False)
    wind = WIND.model_copy(update={"file": str(file)})
    loads = make_top_loads(wind, streams(), steps=5000, step=STEP)
    np.testing.assert_allclose(loads[:, 0], 1e6 + 1e4 * STEP * np.arange(5000))
    with pytest.raises(InputError, match=r"holds 59.5 s, but record.duration asks for 100 s"):
        make_top_loads(wind, streams(), steps=10000, step=STEP)
    table.assign(side=1e150).to_csv(file, index=False)
    with pytest.raises(
        InputError, match=r"side \(channel side\) holds 1e\+150 in SI units, and no load reaches"
    ):
        make_top_loads(wind, streams(), steps=5000, step=STEP)
    table.head(0).to_csv(file, index=False)
    with pytest.raises(InputError, match="has no table of numbers"):
        make_top_loads(wind, streams(), steps=5000, step=STEP)
    table.to_csv(tmp_path / "top.csv.gz", index=False)
    cut = tmp_path / "cut.csv.gz"
    cut.write_bytes((tmp_path / "top.csv.gz").read_bytes()[:-200])
    with pytest.raises(InputError, match=r"cut.csv.gz: cannot be read"):
        make_top_loads(wind.model_copy(update={"file": str(cut)}), streams(), steps=5000, step=STEP)
    table.drop(columns="side").to_csv(file, index=False)
    with pytest.raises(InputError, match=r"no column side; it has .*; call its column side"):
        make_top_loads(wind, streams(), steps=5000, step=STEP)
