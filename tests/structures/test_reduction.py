"""The cut structure and its reduction against closed forms and the full model (IEA-15)."""

import numpy as np
import pytest
from scipy.linalg import eigh

from owtsweep.errors import InputError
from owtsweep.structures import compute_modes, find_structure
from owtsweep.structures.bernoulli import (
    assemble_cut,
    assemble_whole,
    moment_matrix,
    strain_matrix,
    stress_matrix,
)
from owtsweep.structures.reduction import reduce_free, reduce_held

GROUND, TOP = -30.0, 145.0
INTERFACES = [0, 1, 38, 39]


@pytest.fixture(scope="module")
def structure():
    return find_structure("iea15")


@pytest.fixture(scope="module")
def cut(structure):
    return assemble_cut(structure, GROUND, TOP)


def frequencies(beam) -> np.ndarray:
    return np.sqrt(np.abs(eigh(beam.stiffness, beam.mass, eigvals_only=True))) / (2.0 * np.pi)


def test_the_free_substructure_has_the_published_frequencies(cut):
    # the prototype's, by another finite element code: STUDIES.md, section 1.3
    assert len(cut.heights) == 20
    np.testing.assert_allclose(frequencies(cut)[2:5], [1.57322, 3.96255, 7.44158], rtol=1e-5)


def test_a_finer_mesh_changes_little_below_13_hz(structure, cut):
    finer = frequencies(assemble_cut(structure, GROUND, TOP, subdivision=4))
    np.testing.assert_allclose(frequencies(cut)[2:6], finer[2:6], rtol=1e-3)


def test_the_whole_turbine_is_that_of_the_prints(structure):
    bare, heavy = (frequencies(assemble_whole(structure, gravity=g))[0] for g in (False, True))
    assert bare == pytest.approx(0.162, rel=0.03)
    assert heavy == pytest.approx(0.156, rel=0.03)


def test_timoshenkos_beam_on_the_same_foundation_agrees(structure):
    # another element, shear and all: within half a per cent in the first two modes
    modes = compute_modes(structure, 1).frequency
    slender = frequencies(assemble_whole(structure))[:1]
    np.testing.assert_allclose(modes, slender, rtol=5e-3)


def test_the_foundation_pushes_back_against_motion_and_leans_with_it(structure):
    # a force at the ground alone moves the ground its way, and turns it the same way
    moved = np.linalg.solve(structure.foundation.matrix(), [1.0, 0.0])
    assert np.all(moved > 0.0)


def test_the_reduced_substructure_keeps_the_lowest_free_frequencies(cut):
    reduced = reduce_free(cut, INTERFACES, 2)
    np.testing.assert_allclose(reduced.omega[2:4] / (2.0 * np.pi), frequencies(cut)[2:4], rtol=1e-9)
    assert reduced.kinds == ("rigid",) * 2 + ("normal",) * 2 + ("attachment",) * 4


def test_the_reduced_coordinates_are_orthogonal_with_unit_masses(cut):
    reduced = reduce_free(cut, INTERFACES, 3)
    basis = reduced.basis
    np.testing.assert_allclose(basis.T @ cut.mass @ basis, np.eye(9), atol=1e-9)
    stiffness = basis.T @ cut.stiffness @ basis
    np.testing.assert_allclose(stiffness, reduced.stiffness, atol=1e-9 * stiffness.max())


@pytest.mark.parametrize("held", [(10, 11), (0, 38), (20, 31)])
def test_rira_does_not_depend_on_the_degrees_of_freedom_that_are_held(cut, held):
    one = reduce_free(cut, INTERFACES, 2).basis
    other = reduce_free(cut, INTERFACES, 2, constrained=held).basis
    np.testing.assert_allclose(one @ one.T @ cut.mass, other @ other.T @ cut.mass, atol=1e-6)


def test_the_answer_to_static_interface_loads_is_exact(cut):
    reduced = reduce_free(cut, INTERFACES, 2)
    loads = np.zeros(40)
    loads[INTERFACES] = np.random.default_rng(1).normal(size=4) * [1e6, 1e8, 1e6, 1e8]
    rigid, flexible = reduced.basis[:, :2], reduced.basis[:, 2:]
    # relieved by the inertia of rigid acceleration, the beam bends like this
    balanced = loads - cut.mass @ rigid @ (rigid.T @ loads)
    bent = np.zeros(40)
    bent[2:] = np.linalg.solve(cut.stiffness[2:, 2:], balanced[2:])
    bent -= rigid @ (rigid.T @ cut.mass @ bent)
    answer = flexible @ (flexible.T @ loads / reduced.omega[2:] ** 2)
    np.testing.assert_allclose(answer, bent, atol=1e-8 * np.abs(bent).max())


def test_weight_softens_the_modes_of_a_held_structure(structure):
    bare, heavy = (
        reduce_held(assemble_whole(structure, gravity=g), 3).omega for g in (False, True)
    )
    assert np.all(heavy < bare)


def test_a_clamped_structure_has_the_modes_of_its_timoshenko_twin():
    structure = find_structure("oc3_monopile")
    own = reduce_held(assemble_whole(structure, gravity=False), 1).omega[0] / (2.0 * np.pi)
    twin = compute_modes(structure.model_copy(update={"gravity": 1e-9, "water": None}), 1)
    wet = compute_modes(structure, 1).frequency[0]
    assert wet < own < 1.02 * twin.frequency[0]


def test_moments_and_stress_of_a_clamped_beam_with_a_force_at_its_top(structure, cut):
    bent, force = np.zeros(40), np.zeros(40)
    force[38] = 1e6
    bent[2:] = np.linalg.solve(cut.stiffness[2:, 2:], force[2:])
    lever = TOP - cut.heights
    moment = moment_matrix(structure, cut) @ bent
    np.testing.assert_allclose(moment, 1e6 * lever, atol=0.01 * moment.max())
    np.testing.assert_allclose(moment[:9], 1e6 * lever[:9], rtol=1e-6)  # pipes without taper
    tube = structure.tubes[0]
    ground = 1e6 * lever[0] * 5.0 / tube.inertia(np.array([GROUND]))[0]
    assert (stress_matrix(structure, cut) @ bent)[0] == pytest.approx(ground, rel=1e-6)
    assert (strain_matrix(structure, cut) @ bent)[0] == pytest.approx(ground / 2.1e11, rel=1e-6)


def test_the_thinner_wall_counts_at_a_change_of_wall(structure, cut):
    node = 1  # 5 m above the ground: 55 mm below, 53 mm above
    thin = structure.tubes[1].inertia(np.array([-25.0]))[0]
    stress, moment = stress_matrix(structure, cut)[node], moment_matrix(structure, cut)[node]
    np.testing.assert_allclose(stress, 5.0 / thin * moment, rtol=1e-5)


def test_shape_functions_do_the_work_of_the_beam(cut):
    heights = np.array([-30.0, -12.3, 20.0, 145.0])
    lean = np.zeros(40)
    lean[0::2], lean[1::2] = 0.5 + 0.01 * cut.heights, 0.01
    np.testing.assert_allclose(cut.interpolate(heights) @ lean, 0.5 + 0.01 * heights, rtol=1e-12)


def test_a_cut_inside_an_element_says_where_to_cut(structure):
    with pytest.raises(
        InputError, match=r"cuts: the low one at 2 m above the ground is inside an element; cut"
    ):
        assemble_cut(structure, -28.0, TOP)


def test_one_element_is_no_substructure(structure):
    with pytest.raises(InputError, match=r"cuts: 1 element .* needs 2 or more"):
        assemble_cut(structure, 132.0, TOP)


def test_a_height_without_a_node_names_the_nearest(cut):
    with pytest.raises(InputError, match=r"sensors.x: no node .* 1 m .* nearest are at 0, "):
        cut.find_node(1.0, "sensors.x")
