"""Choose places of sensors without any record, from the settled covariance of the AKF.

The augmented Kalman filter on the cut structure (Simpson et al. 2025, Algorithm 1) has a covariance
that no measurement changes. So what a further sensor buys is known before it is mounted: the
standard deviations of the stress at each weld and of M0, each as a share of a scale.

Set-ups without a displacement do not see the rigid translation: its covariance grows without bound.
Position and velocity of this one mode are left out of the model. That changes nothing else. No
inclinometer and no accelerometer measures them, no other state's equation holds them (the mode has
neither stiffness nor damping), and neither stress nor interface loads depend on them. The
covariance of all other states settles if the sensors see them, and is then found by doubling the
number of steps. A set-up that does not see all of them has an infinite error; that is decided
beforehand by the rank of what its sensors read, because rounding may feign a covariance that
settles.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb
from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.estimation.augmented import augment_walks
from owtsweep.estimation.periodic import CovarianceMap, find_steady_covariance
from owtsweep.io.terminal import tell_step
from owtsweep.studies.tower.contract import Channel, Kind, Setting
from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.schemes.filtered import find_noise

#: The covariance has settled when doubling the number of steps changes variances by less than this.
SETTLED = 1e-6
#: Most doublings: 2^17 steps are 22 minutes at 100 Hz. What has not settled then counts as unseen.
DOUBLINGS = 17
#: Most sets of sensors that an exhaustive choice tries: some minutes.
MOST_SETS = 200_000
#: From so many sets on, an exhaustive choice tells how far it is.
MANY_SETS = 1000
#: A column this small beside the largest entry of its matrix is zero.
NOTHING = 1e-9
#: By what a set of sensors is judged.
Criterion = Literal["stress", "moment"]


@dataclass(frozen=True)
class PlacementCase:
    """A structure with its sensors to choose from, in one direction.

    setting: the structure and its tuning; the channels are the sensors that are there already.
    candidates: Inclinometers to choose from, upwards.
    stress, welds: Stress (Pa) at the judged welds for unit degrees of freedom of the cut, shape
        (welds, dof), and heights of these welds above ground in m, shape (welds,).
    stress_scale, moment_scale: Standard deviations of the true stress at these welds in Pa, shape
        (welds,), and of the true M0 in N m.
    ground: Height of the ground above mean sea level in m.
    wave: whether the wave load is a further unknown.
    """

    setting: Setting
    candidates: tuple[Channel, ...]
    stress: Array
    welds: Array
    stress_scale: Array
    moment_scale: float
    ground: float
    wave: bool

    def list_there(self) -> dict[Kind, list[float]]:
        """Return the heights above ground (m) of the sensors that are there, by kind."""
        there: dict[Kind, list[float]] = {}
        for channel in self.setting.channels:
            height = float(self.setting.cut.heights[channel.node] - self.ground)
            there.setdefault(channel.kind, []).append(height)
        return there


@dataclass(frozen=True)
class Problem:
    """What is known before sensors are chosen, for one direction.

    The state is augmented by the loads, and every component is scaled by the standard deviation of
    its own process noise, so that the process noise's covariance is the identity.

    transition: Transition of the state per step, shape (n, n).
    given: Information per step of the sensors that are there: the sum of h h' / sigma^2 over their
        rows h, shape (n, n).
    heights, rows: Heights of the candidate sensors above ground in m, shape (candidates,), and
        their rows h / sigma, shape (candidates, n).
    stress: Stress at each weld as a share of its scale, from the state, shape (welds, n).
    moment: Moment M0 as a share of its scale, from the state, shape (n,).
    lasting: What the candidates read of the directions of state that last for ever (eigenvalue 1)
        and that the given sensors do not see, shape (candidates, directions).
    """

    transition: Array
    given: Array
    heights: Array
    rows: Array
    stress: Array
    moment: Array
    lasting: Array


@dataclass(frozen=True)
class Choice:
    """A set of candidate sensors with its predicted errors.

    `chosen`, `heights`: numbers of the candidates, increasing, and their heights above ground in m.
    `stress`, `weld`: standard deviation of the stress over its scale at the worst weld, inf if it
    never settles; and the number of this weld. `moment`: standard deviation of M0 over its scale;
    inf if it never settles.
    """

    chosen: tuple[int, ...]
    heights: tuple[float, ...]
    stress: float
    weld: int
    moment: float

    def error(self, criterion: Criterion) -> float:
        """Return the predicted error by a criterion."""
        return self.stress if criterion == "stress" else self.moment


def pose(case: PlacementCase) -> Problem:
    """Pose the choice of sensors for one direction; errors are shares of the case's scales."""
    setting, candidates = case.setting, case.candidates
    known = replace(setting, channels=(*setting.channels, *candidates))
    model = model_cut(known, wave=case.wave)
    noise = find_noise(known, model)
    transition, rows, Q = augment_walks(model.discrete, noise.Q, noise.S)
    size, sigma = np.sqrt(np.diag(Q)), np.sqrt(np.diag(noise.R))
    transition = transition * size / size[:, None]
    rows = rows * size / sigma[:, None]
    bent = np.zeros((len(case.stress), len(size)))
    bent[:, : model.modes] = case.stress @ model.basis
    bent *= size / case.stress_scale[:, None]
    moment = np.concatenate([model.loads_of_state[1], model.loads_of_input[1]])
    moment = moment * size / case.moment_scale
    wanted = np.vstack([rows, bent, moment])
    kept = _leave_out_translation(transition, wanted, model.modes)
    transition = transition[kept][:, kept]
    given, offered = np.split(rows[:, kept], [len(setting.channels)])
    return Problem(
        transition=transition,
        given=given.T @ given,
        heights=setting.cut.heights[[channel.node for channel in candidates]] - case.ground,
        rows=offered,
        stress=bent[:, kept],
        moment=moment[kept],
        lasting=_see_lasting(transition, given, offered),
    )


def _see_lasting(transition: Array, given: Array, rows: Array) -> Array:
    """Return what `rows` read of lasting directions that `given` rows do not see.

    Lasting is what the transition returns unchanged (eigenvalue 1): a lean, and loads in balance.
    All other directions fade. So by the test of Popov, Belevitch and Hautus, sensors see all that
    matters if they see each lasting direction.
    """
    directions = _null_space(_normalise(transition - np.eye(len(transition))))
    unseen = directions @ _null_space(_normalise(given) @ directions)
    return np.asarray(_normalise(rows) @ unseen)


def _null_space(matrix: Array) -> Array:
    """Return an orthonormal basis of what a matrix (m, n) maps to zero, shape (n, dimension)."""
    _, values, right = np.linalg.svd(matrix)
    return np.asarray(right[int(np.sum(values > NOTHING)) :].T)


def _normalise(rows: Array) -> Array:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(rows / np.where(length > 0.0, length, 1.0))


def _leave_out_translation(transition: Array, wanted: Array, modes: int) -> list[int]:
    """Return the numbers of the states that stay when the rigid translation is left out.

    The translation is the first mode. Its position and velocity stay, too, if a row of `wanted`
    (sensors and wanted quantities) or another state's equation holds one of them.
    """
    pair = [0, modes]
    kept = [number for number in range(len(transition)) if number not in pair]
    others = np.abs(transition[kept][:, pair]).max()
    read = np.abs(wanted[:, pair]) / np.abs(wanted).max(axis=1, keepdims=True)
    if others <= NOTHING and read.max() <= NOTHING:
        return kept
    return list(range(len(transition)))


def settle(problem: Problem, chosen: Iterable[int]) -> Array | None:
    """Compute the settled covariance of the filtered state with some candidates beside the given.

    The shape is (n, n); None if it does not settle: the sensors do not see all states.
    """
    numbers = list(chosen)
    seen = np.linalg.svd(problem.lasting[numbers], compute_uv=False)
    if int(np.sum(seen > NOTHING)) < problem.lasting.shape[1]:
        return None
    rows = problem.rows[numbers]
    information = problem.given + rows.T @ rows
    one = np.eye(len(information))
    step = CovarianceMap(problem.transition, information, one)
    try:
        predicted = find_steady_covariance(step, SETTLED, DOUBLINGS)
    except InputError:
        return None
    return np.asarray(np.linalg.solve(one + predicted @ information, predicted))


def predict(problem: Problem, chosen: Iterable[int]) -> Choice:
    """Predict the errors with some candidates (by their numbers) beside the given sensors."""
    numbers = tuple(sorted(chosen))
    heights = tuple(float(problem.heights[number]) for number in numbers)
    covariance = settle(problem, numbers)
    if covariance is None:
        return Choice(numbers, heights, np.inf, 0, np.inf)
    variances = np.einsum("wi,ij,wj->w", problem.stress, covariance, problem.stress)
    weld = int(np.argmax(variances))
    return Choice(
        numbers,
        heights,
        float(np.sqrt(variances[weld])),
        weld,
        float(np.sqrt(problem.moment @ covariance @ problem.moment)),
    )


def choose_exhaustively(problem: Problem, count: int, criterion: Criterion = "stress") -> Choice:
    """Try every set of `count` candidates; return the one with the least predicted error.

    Raise `InputError` if there are fewer candidates, or more sets than can be tried.
    """
    candidates = _count_candidates(problem, count)
    sets = comb(candidates, count)
    require(
        sets <= MOST_SETS,
        f"--heights: {count} of {candidates} are {sets} sets, more than {MOST_SETS}; give fewer",
    )
    best = predict(problem, range(count))
    for number, chosen in enumerate(combinations(range(candidates), count)):
        if sets >= MANY_SETS and number % (sets // 10) == 0:
            tell_step(f"{number} of {sets} sets of {count} inclinometers")
        choice = predict(problem, chosen)
        if choice.error(criterion) < best.error(criterion):
            best = choice
    return best


def choose_greedily(problem: Problem, count: int, criterion: Criterion = "stress") -> list[Choice]:
    """Add one sensor at a time, each where it lowers the predicted error most.

    With too few sensors every error is infinite, and no first sensor is better than another. So the
    smallest set with a finite error is chosen exhaustively, and single sensors are added to it.
    Return the sets of that smallest number of sensors, of one more, ..., of `count`. Raise
    `InputError` if there are fewer candidates, or no set of `count` candidates has a finite error.
    """
    _count_candidates(problem, count)
    for fewest in range(count + 1):
        best = choose_exhaustively(problem, fewest, criterion)
        if np.isfinite(best.error(criterion)):
            break
    else:
        raise InputError(
            f"--count: no {count} of the candidate heights let the filter see all loads; a cut has "
            "4 unknown loads (5 in waves), of which accelerometers see 2: choose 3 or more "
            "inclinometers (4 in waves), beside 2 or more accelerometers",
        )
    choices = [best]
    while len(choices[-1].chosen) < count:
        choices.append(min(extend(problem, choices[-1]), key=lambda c: c.error(criterion)))
    return choices


def extend(problem: Problem, choice: Choice) -> list[Choice]:
    """Return the sets with one candidate more, upwards: what a next sensor buys at each height."""
    others = [n for n in range(len(problem.heights)) if n not in choice.chosen]
    return [predict(problem, (*choice.chosen, number)) for number in others]


def _count_candidates(problem: Problem, count: int) -> int:
    """Return the number of candidates; raise `InputError` if `count` are more than that."""
    candidates = len(problem.heights)
    require(
        0 <= count <= candidates,
        f"--count: {count} inclinometers, but there are {candidates} candidate heights; give more "
        "heights or choose fewer",
    )
    return candidates
