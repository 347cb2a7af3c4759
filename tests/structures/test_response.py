"""The exact response against closed forms and a fine numerical integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from owtsweep.errors import InputError
from owtsweep.structures.response import Outputs, respond


def ask_all(dof: int) -> Outputs:
    """Ask for displacements, then velocities, then accelerations of all degrees of freedom."""
    zero, one = np.zeros((dof, dof)), np.eye(dof)
    return Outputs(
        np.vstack([one, zero, zero]), np.vstack([zero, one, zero]), np.vstack([zero, zero, one])
    )


@pytest.fixture(scope="module")
def chain():
    """Return three masses in a row, with a damper at the last one alone."""
    mass = np.diag([2.0, 1.0, 3.0])
    stiffness = 40.0 * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    damping = 0.002 * stiffness
    damping[2, 2] += 1.5
    return mass, damping, stiffness


def test_an_oscillator_follows_its_closed_form():
    omega, zeta, step = 2.0, 0.05, 0.02
    time = step * np.arange(400)
    series, loads = 0.3 * time[:, None], np.array([[1.0]])
    got = respond(np.eye(1), np.array([[2.0 * zeta * omega]]), np.array([[omega**2]]), loads,
                  series, step, ask_all(1))  # fmt: skip
    slope = 0.3 / omega**2
    own = omega * np.sqrt(1.0 - zeta**2)
    a = 2.0 * zeta / omega * slope
    b = (zeta * omega * a - slope) / own
    ringing = np.exp(-zeta * omega * time) * (a * np.cos(own * time) + b * np.sin(own * time))
    expected = slope * time - 2.0 * zeta / omega * slope + ringing
    np.testing.assert_allclose(got[:, 0], expected, atol=1e-12)


def test_coupled_damping_agrees_with_a_fine_integration(chain):
    mass, damping, stiffness = chain
    step, steps = 0.05, 200
    random = np.random.default_rng(2)
    series = random.normal(loc=[1.0, -0.5], size=(steps, 2))
    loads = np.array([[1.0, 0.0], [0.0, 0.5], [0.0, 2.0]])
    got = respond(mass, damping, stiffness, loads, series, step, ask_all(3))
    time = step * np.arange(steps)
    inverse = np.linalg.inv(mass)

    def move(t: float, x: np.ndarray) -> np.ndarray:
        f = np.array([np.interp(t, time, column) for column in series.T])
        return np.concatenate([x[3:], inverse @ (loads @ f - damping @ x[3:] - stiffness @ x[:3])])

    start = np.concatenate([np.linalg.solve(stiffness, loads @ series[0]), np.zeros(3)])
    fine = solve_ivp(move, (0.0, time[-1]), start, t_eval=time, rtol=1e-9, atol=1e-11,
                     max_step=step / 2)  # fmt: skip
    np.testing.assert_allclose(got[:, :6], fine.y.T, atol=2e-6)
    # and the equation of motion holds at every sample
    balance = got[:, 6:] @ mass + got[:, 3:6] @ damping + got[:, :3] @ stiffness
    np.testing.assert_allclose(balance, series @ loads.T, atol=1e-10)


def test_responses_add_up(chain):
    random = np.random.default_rng(3)
    series = random.normal(size=(300, 2))
    loads = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    whole = respond(*chain, loads, series, 0.1, ask_all(3))
    parts = [respond(*chain, loads[:, [i]], series[:, [i]], 0.1, ask_all(3)) for i in range(2)]
    np.testing.assert_allclose(whole, parts[0] + parts[1], atol=1e-12)


def test_a_constant_load_moves_nothing(chain):
    series = np.full((50, 1), 3.0)
    loads = np.array([[1.0], [0.0], [0.0]])
    got = respond(*chain, loads, series, 0.1, ask_all(3))
    static = np.linalg.solve(chain[2], 3.0 * loads[:, 0])
    np.testing.assert_allclose(got[:, :3], np.tile(static, (50, 1)), atol=1e-12)
    np.testing.assert_allclose(got[:, 3:], 0.0, atol=1e-11)


def test_a_free_structure_is_refused(chain):
    mass, damping, stiffness = (matrix.copy() for matrix in chain)
    stiffness[0, 0] -= 40.0
    with pytest.raises(InputError, match="does not stand"):
        respond(mass, damping, stiffness, np.eye(3), np.zeros((9, 3)), 0.1, ask_all(3))
