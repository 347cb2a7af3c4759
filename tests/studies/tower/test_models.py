"""State space of the cut and of the whole structure, against direct integration and equilibrium."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from settings import CUT, STRAIN, make_setting
from turbine import STEP, STRUCTURE

from owtsweep.studies.tower.models import model_cut, model_whole

CHANNELS = {"x": (84,), "theta": (30, 175), "a": (35, 175), "strain": (0, 97)}


@pytest.fixture(scope="module")
def setting():
    return make_setting(CHANNELS, 1.0)


@pytest.mark.parametrize("make", [model_cut, model_whole])
def test_states_and_outputs_equal_direct_integration(setting, make):
    # the equation of motion in modal coordinates, integrated anew; loads are held over each step
    whole = make is model_whole
    model = make(setting, wave=True)
    beam = setting.whole if whole else CUT
    basis = model.basis  # the whole's nodes are those of the cut here
    loads = np.zeros((len(beam.mass), 5))
    loads[[0, 1, -2, -1], range(4)] = 1.0
    loads[:, 4] = setting.wave_shape
    loads = loads[:, model.inputs]
    mass = basis.T @ beam.mass @ basis
    stiffness, damping = basis.T @ beam.stiffness @ basis, basis.T @ setting.whole_damping @ basis
    rng = np.random.default_rng(1)
    steps, modes = 5, basis.shape[1]
    inputs = rng.standard_normal((steps, len(model.inputs)))  # in units of `scale`
    forces = basis.T @ loads @ (inputs * model.scale).T

    def accelerate(z, rate, k):
        return np.linalg.solve(mass, forces[:, k] - damping @ rate - stiffness @ z)

    state = np.concatenate([rng.standard_normal(modes) / (1.0 + setting.reduced.omega.max()),
                            rng.standard_normal(modes)])  # fmt: skip
    discrete = model.discrete
    ours = state.copy()
    for k in range(steps):
        z, rate = state[:modes], state[modes:]
        u, a = basis @ z, basis @ accelerate(z, rate, k)
        expected = []
        for channel in setting.channels:
            w = 2 * channel.node
            read = {"x": u[w], "theta": u[w + 1], "a": a[w], "strain": STRAIN[channel.node] @ u}
            expected.append(read[channel.kind])
        assert np.allclose(discrete.G @ ours + discrete.J @ inputs[k], expected, rtol=1e-6, atol=0)
        answer = solve_ivp(
            lambda _, x, k=k: np.concatenate([x[modes:], accelerate(x[:modes], x[modes:], k)]),
            (0.0, STEP),
            state,
            method="DOP853",
            rtol=1e-11,
            atol=1e-13,
        )
        state = answer.y[:, -1]
        ours = discrete.A @ ours + discrete.B @ inputs[k]
        assert np.allclose(ours, state, rtol=1e-7, atol=1e-8 * np.abs(state).max())


@pytest.mark.parametrize("wave", [False, True])
def test_interface_loads_of_the_whole_are_those_that_move_the_cut(setting, wave):
    # with all modes the model is the finite-element model, and each row of the cut's equation of
    # motion can be read: loads at its ends are what its inertia, damping and stiffness need
    full = replace(setting, whole_modes=len(setting.whole.mass))
    model = model_whole(full, wave=wave)
    rng = np.random.default_rng(2)
    modes = model.modes
    states = rng.standard_normal((3, 2 * modes))
    states[:, :modes] /= 100.0
    inputs = rng.standard_normal((3, len(model.inputs)))
    estimates = model.read(states, inputs)
    beam = full.whole
    loads = np.zeros((len(beam.mass), 5))
    loads[[0, 1, -2, -1], range(4)] = 1.0
    loads[:, 4] = full.wave_shape
    external = loads[:, model.inputs] @ (inputs * model.scale).T
    u, v = model.basis @ states[:, :modes].T, model.basis @ states[:, modes:].T
    a = np.linalg.solve(beam.mass, external - full.whole_damping @ v - beam.stiffness @ u)
    needed = CUT.mass @ a + full.cut_damping @ v + CUT.stiffness @ u
    if wave:
        needed -= np.outer(full.wave_shape, inputs[:, 2] * model.scale[2])
        assert np.allclose(estimates.wave, inputs[:, 2] * model.scale[2])
    else:
        assert estimates.wave is None
    expected = needed[[0, 1, -2, -1]].T
    assert np.allclose(estimates.inputs, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max(0))
    springs = STRUCTURE.foundation.matrix()
    assert np.allclose(estimates.inputs[:, :2], -u[:2].T @ springs, rtol=1e-8)


def test_scale_of_inputs_changes_no_physical_response(setting):
    # a unit that is a hundred times larger takes a number that is a hundred times smaller
    priors = setting.priors
    larger = replace(setting, priors=replace(priors, step_sigma=100.0 * priors.step_sigma))
    for make in (model_cut, model_whole):
        one, other = make(setting), make(larger)
        expected = 100.0 * one.discrete.B
        assert np.allclose(other.discrete.B, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
        assert np.allclose(other.discrete.J, 100.0 * one.discrete.J)
        assert np.allclose(other.loads_of_input, 100.0 * one.loads_of_input)
