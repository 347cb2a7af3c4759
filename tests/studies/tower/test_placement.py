"""Places of inclinometers, judged by the settled covariance of the AKF."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from turbine import CUTS, STEP, STRUCTURE

from owtsweep.errors import InputError
from owtsweep.structures.bernoulli import assemble_cut, assemble_whole, strain_matrix, stress_matrix
from owtsweep.structures.reduction import reduce_free
from owtsweep.studies.tower.contract import Channel, Priors, Setting
from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.placement import (
    PlacementCase,
    Problem,
    choose_exhaustively,
    choose_greedily,
    extend,
    pose,
    predict,
)
from owtsweep.studies.tower.truth import find_damping
from owtsweep.studies.tower.tuning import Tuning

CUT = assemble_cut(STRUCTURE, *CUTS)
NODES = len(CUT.heights)
STRESS = stress_matrix(STRUCTURE, CUT)
FORCE, MOMENT = 1.7e4, 1.7e6
PLACES = (0, 4, 6, 10, 13, 17, 19)


def theta(*nodes: int) -> list[Channel]:
    return [Channel("theta", node, 2e-5) for node in nodes]


@pytest.fixture(scope="module")
def setting() -> Setting:
    whole = assemble_whole(STRUCTURE)
    tuning = Tuning(
        inputs="declared", process_noise=1e-3, initial=1e6, force=FORCE,
        moment=MOMENT, wave=2e3, correlation_time=10.0, lag=0.1,
    )  # fmt: skip
    return Setting(
        direction="fa", cut=CUT, cut_damping=find_damping(STRUCTURE, CUT),
        reduced=reduce_free(CUT, [0, 1, 2 * NODES - 2, 2 * NODES - 1], 2), whole=whole,
        whole_damping=np.zeros_like(whole.mass), nodes=np.arange(NODES),
        wave_shape=np.zeros(2 * NODES), strain=strain_matrix(STRUCTURE, CUT),
        channels=tuple(Channel("a", node, 2e-3) for node in (0, 8, 12, 19)), step=STEP,
        priors=Priors(np.array([FORCE, MOMENT, FORCE, MOMENT, 2e3]), np.ones(5), np.ones(5)),
        tuning=tuning,
        rate_noise=2e-3,
    )  # fmt: skip


def choose_among(setting: Setting, candidates: list[Channel]) -> Problem:
    """Return the problem with errors in MPa and MN m."""
    case = PlacementCase(
        setting, tuple(candidates), STRESS, CUT.heights - CUT.heights[0], np.full(NODES, 1e6), 1e6,
        ground=CUT.heights[0], wave=False,
    )  # fmt: skip
    return pose(case)


@pytest.fixture(scope="module")
def problem(setting):
    return choose_among(setting, theta(*PLACES))


def recurse(setting, channels, steps):
    """Run Algorithm 1's covariance with all states; return P of the model's states and loads."""
    model = model_cut(replace(setting, channels=(*setting.channels, *channels)))
    states, loads = 2 * model.modes, len(model.scale)
    A = np.eye(states + loads)
    A[:states] = np.hstack([model.discrete.A, model.discrete.B])
    G = np.hstack([model.discrete.G, model.discrete.J])
    noise = [setting.tuning.process_noise, setting.rate_noise]
    Q = np.diag([*np.repeat(noise, states // 2), *[1.0] * loads])
    R = np.diag([c.sigma**2 for c in (*setting.channels, *channels)])
    P = 100.0 * Q
    for _ in range(steps):
        P = A @ P @ A.T + Q
        gain = np.linalg.solve(G @ P @ G.T + R, G @ P).T
        rest = np.eye(len(P)) - gain @ G
        P = rest @ P @ rest.T + gain @ R @ gain.T
    return model, P


def test_the_translation_that_is_left_out_changes_nothing(setting, problem):
    # Algorithm 1 step by step, with all states: the translation's variance grows all the while
    chosen = (0, 3, 5, 6)
    places = theta(*(PLACES[number] for number in chosen))
    model, P = recurse(setting, places, 1500)
    modes = model.modes
    assert len(problem.transition) == len(P) - 2
    rows = STRESS @ model.basis
    stress = np.sqrt(np.einsum("wi,ij,wj->w", rows, P[:modes, :modes], rows))
    got = predict(problem, chosen)
    assert got.heights == (0.0, 58.0, 149.0, 175.0)
    assert got.stress == pytest.approx(stress.max() / 1e6, rel=1e-5)
    assert got.weld == np.argmax(stress)
    moment = model.scale[1] * np.sqrt(P[2 * modes + 1, 2 * modes + 1])
    assert got.moment == pytest.approx(moment / 1e6, rel=1e-5)
    assert P[0, 0] > 2.0 * recurse(setting, places, 1000)[1][0, 0]


def test_a_displacement_keeps_the_translation(setting):
    with_fix = replace(setting, channels=(*setting.channels, Channel("x", 19, 0.01)))
    problem = choose_among(with_fix, theta(*PLACES))
    assert len(problem.transition) == 2 * len(setting.reduced.omega) + 4
    model, P = recurse(with_fix, theta(*PLACES), 1500)
    moment = model.scale[1] * np.sqrt(P[2 * model.modes + 1, 2 * model.modes + 1])
    assert predict(problem, range(7)).moment == pytest.approx(moment / 1e6, rel=1e-4)


@pytest.mark.parametrize("criterion", ["stress", "moment"])
def test_greedy_begins_where_the_error_is_finite(problem, criterion):
    greedy = choose_greedily(problem, 5, criterion)
    assert [len(choice.chosen) for choice in greedy] == [3, 4, 5]
    assert greedy[0] == choose_exhaustively(problem, 3, criterion)
    assert choose_exhaustively(problem, 2, criterion).error(criterion) == np.inf
    errors = [choice.error(criterion) for choice in greedy]
    assert errors == sorted(errors, reverse=True)
    for choice in greedy:  # brute force of its own
        tried = [predict(problem, s).error(criterion)
                 for s in combinations(range(7), len(choice.chosen))]  # fmt: skip
        best = choose_exhaustively(problem, len(choice.chosen), criterion)
        assert best.error(criterion) == min(tried)
        assert min(tried) <= choice.error(criterion) <= 1.2 * min(tried)


def test_a_further_sensor_never_does_harm(problem):
    begun = predict(problem, (0, 3, 6))
    further = extend(problem, begun)
    assert [set(choice.chosen) - {0, 3, 6} for choice in further] == [{1}, {2}, {4}, {5}]
    assert all(c.moment < begun.moment and c.stress < begun.stress for c in further)


def test_accelerometers_alone_see_no_bending(setting):
    problem = choose_among(setting, theta(0, 19))
    assert predict(problem, ()).moment == np.inf
    with pytest.raises(InputError, match=r"count: no 2 of the candidate heights let the filter"):
        choose_greedily(problem, 2)


def test_impossible_counts_are_refused(setting, problem):
    with pytest.raises(InputError, match="count: 8 inclinometers, but there are 7 candidate"):
        choose_exhaustively(problem, 8)
    many = choose_among(setting, theta(*PLACES, *PLACES, *PLACES, *PLACES))
    with pytest.raises(InputError, match="heights: 10 of 28 are 13123110 sets, more than"):
        choose_exhaustively(many, 10)


def test_rounding_does_not_make_two_inclinometers_enough(setting):
    # with quiet sensors, rounding alone would stop the growth of the covariance
    quiet = tuple(replace(channel, sigma=1e-5) for channel in setting.channels)
    candidates = [replace(channel, sigma=1e-6) for channel in theta(*PLACES)]
    problem = choose_among(replace(setting, channels=quiet), candidates)
    for count, seen in ((1, False), (2, False), (3, True)):
        for chosen in combinations(range(len(PLACES)), count):
            assert np.isfinite(predict(problem, chosen).moment) == seen
