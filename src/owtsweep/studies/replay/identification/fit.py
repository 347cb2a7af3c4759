"""Fit noise and delay by maximum likelihood, and find a force that contradicts the positions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from owtsweep.arrays import Array
from owtsweep.gravity import STANDARD_GRAVITY
from owtsweep.studies.replay.identification.likelihood import PARAMETERS, REACH, Problem

#: Least and largest IMU sigma (m/s^2), position sigma (m) and bias walk (m/s^2/sqrt(s)) tried.
LEAST, LARGEST = np.array([1e-5, 1e-5, 1e-7]), np.array([1e3, 1e4, 1e2])
#: Delays are searched first on a grid of this step, s.
SCAN = 0.02
#: Unit of the delay in the search, s, so that a step of 1 matters as much as in a logarithm.
UNIT = 0.02
#: Half of the 95 % quantile of chi square with one degree of freedom.
DROP = 1.9207
#: ... and half of the 99.9 % quantile.
ALLOWED = 5.414
#: Steps of the search for the edge of an interval.
MOST_STEPS = 15
#: The acceleration is doubted if it misses the positions by this factor more than stated.
DOUBTED = 2.0
#: Another reading of the acceleration must raise the log likelihood by this. If the acceleration is
#: right, any other reading does so with a probability below exp(-10).
EVIDENCE = 10.0
#: ... and make the misfit smaller by this factor.
SMALLER = 2.0
#: Step between the delays at which readings are compared, s.
COARSE = 0.1


@dataclass(frozen=True)
class Fit:
    """The most likely parameters and their 95 % intervals.

    values, low, high: (4,), in the order of `PARAMETERS`; `low` is 0 (a delay: minus infinity) and
        `high` infinity where the record sets no bound.
    log_likelihood: the largest log likelihood.
    kurtosis, kurtosis_error: Excess kurtosis of the innovations, 0 for Gaussian noise, and its
        standard error for such noise.
    """

    values: Array
    low: Array
    high: Array
    log_likelihood: float
    kurtosis: float
    kurtosis_error: float


def fit_noise(problem: Problem, stated: Array, floor: float = np.nan) -> Fit:
    """Fit IMU sigma, position sigma, bias walk and delay by maximum likelihood.

    stated: the stated values, at which the search begins, shape (4,).
    floor: IMU sigma (m/s^2) of the IMU's own spectrum; used if positions do not contradict it, for
        then the IMU's noise is white, and known to a few per cent.
    """
    bounds = _bounds(stated[3])
    best, value = _find_most_likely(problem, stated)
    if np.isfinite(floor):
        start = np.append(np.log(floor), best[1:])
        if _climb(problem, start, bounds, fixed=0)[1] > value - ALLOWED:
            problem = replace(problem, floor=floor)
            best, value = _climb(problem, best, bounds)
    low, high = np.empty((2, len(PARAMETERS)))
    for i in range(len(PARAMETERS)):
        low[i] = _find_edge(problem, best, value, i, bounds, -1.0)
        high[i] = _find_edge(problem, best, value, i, bounds, 1.0)
    values = decode(best)
    innovation, _ = problem.whiten(values[:3], problem.residual(values[3]))
    scaled = innovation / np.sqrt(np.mean(innovation**2))
    return Fit(
        values, decode(low), decode(high), value,
        float(np.mean(scaled**4) - 3.0), float(np.sqrt(24.0 / scaled.size)),
    )  # fmt: skip


def _find_most_likely(
    problem: Problem, stated: Array, gain: Array | None = None
) -> tuple[Array, float]:
    """Return the most likely parameters, encoded, and their log likelihood; `gain`: (2, 2)."""
    starts, bounds = _scan_delays(problem, stated, gain, SCAN)[0], _bounds(stated[3])
    found = [_climb(problem, start, bounds, gain=gain) for start in starts]
    return max(found, key=lambda each: np.nan_to_num(each[1], nan=-np.inf))


def _scan_delays(
    problem: Problem, stated: Array, gain: Array | None, step: float
) -> tuple[list[Array], float]:
    """Return the most likely delays, as encoded parameters, and their log likelihood.

    The noise is the stated one, and ten times as much: a delay can be recognised only at about the
    right size of the noise. `step` is that between tried delays, s.
    """
    delays = np.arange(-REACH, REACH + 0.5 * step, step) + stated[3]
    residuals = [problem.residual(delay, gain) for delay in delays]
    starts, largest = [], -np.inf
    for scale in (1.0, 10.0):
        noise = scale * np.maximum(stated[:3], LEAST)
        tried = [problem.whiten(noise, residual)[1] for residual in residuals]
        starts.append(encode(np.append(noise, delays[int(np.argmax(tried))])))
        largest = max(largest, *tried)
    return starts, largest


def encode(values: Array) -> Array:
    """Return parameters as the search sees them: logarithms of noise, the delay in `UNIT`."""
    return np.append(np.log(values[:3]), values[3] / UNIT)


def decode(parameters: Array) -> Array:
    """Return the values of parameters of the search, shape (4,)."""
    return np.append(np.exp(parameters[:3]), UNIT * parameters[3])


def _bounds(delay: float) -> Array:
    low = encode(np.append(LEAST, delay - REACH))
    return np.stack([low, encode(np.append(LARGEST, delay + REACH))], axis=1)


def _climb(
    problem: Problem,
    start: Array,
    bounds: Array,
    *,
    fixed: int | None = None,
    gain: Array | None = None,
) -> tuple[Array, float]:
    free = np.array([i for i in range(len(start)) if i != fixed])
    whole = start.copy()
    # with the delay fixed, residuals stay
    kept = problem.residual(UNIT * start[3], gain) if fixed == 3 else None

    def cost(part: Array) -> float:
        whole[free] = part
        values = decode(whole)
        residual = problem.residual(values[3], gain) if kept is None else kept
        value = -problem.whiten(values[:3], residual)[1]
        return value if np.isfinite(value) else 1e12

    found = minimize(cost, start[free], method="L-BFGS-B", bounds=bounds[free])
    whole[free] = found.x
    return whole.copy(), -float(found.fun)


def _find_edge(
    problem: Problem, best: Array, value: float, i: int, bounds: Array, sign: float
) -> float:
    """Return where the profile likelihood of parameter i falls by `DROP`, or an infinity."""
    start = best

    def excess(at: float) -> float:
        """Return a number that is nearly linear in the parameter, and zero at the edge."""
        nonlocal start
        start = start.copy()
        start[i] = at
        start, reached = _climb(problem, start, bounds, fixed=i)
        return float(np.sqrt(max(value - reached, 0.0)) - np.sqrt(DROP))

    end = bounds[i, int(sign > 0)]
    inside, at_inside, width = best[i], -float(np.sqrt(DROP)), 0.1
    while True:
        outside = best[i] + sign * width
        if sign * (outside - end) >= 0.0:
            outside = end
        at_outside = excess(outside)
        if at_outside > 0.0:
            break
        if outside == end:
            return float(sign * np.inf)
        inside, at_inside, width = outside, at_outside, 2.0 * width
    for _ in range(MOST_STEPS):
        share = float(np.clip(-at_inside / (at_outside - at_inside), 0.05, 0.95))
        middle = inside + share * (outside - inside)
        at_middle = excess(middle)
        if abs(at_middle) < 0.01:
            return float(middle)
        if at_middle > 0.0:
            outside, at_outside = middle, at_middle
        else:
            inside, at_inside = middle, at_middle
    return float(outside)


def _list_readings() -> dict[str, Array]:
    # what may be wrong, in words -> the matrix (2, 2) that corrects the acceleration
    unit = np.eye(2)
    swapped = unit[::-1]
    readings = {
        "its sign turned": -unit,
        "its axes swapped": swapped,
        "its axes swapped and both signs turned": -swapped,
        "the sign of x turned": np.diag([-1.0, 1.0]),
        "the sign of y turned": np.diag([1.0, -1.0]),
        "the unit g (units.specific_force_x=g units.specific_force_y=g)": STANDARD_GRAVITY * unit,
        "the unit m/s^2 instead of g": unit / STANDARD_GRAVITY,
        "a unit a thousand times smaller": 1e-3 * unit,
        "a unit a thousand times larger": 1e3 * unit,
    }
    for degrees in (45, 90, 135, -135, -90, -45):
        cos, sin = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
        turned = np.array([[cos, -sin], [sin, cos]])
        readings[f"sensors.yaw larger by some {degrees} deg"] = turned
    return readings


def describe_disagreement(problem: Problem, stated: Array, fit: Fit, source: str) -> str:
    """Say why the acceleration cannot belong to the positions; "" if both can be of one motion.

    stated, fit: the stated values, shape (4,), and the fit of the acceleration as it is.
    source: what the positions are: "fixes" or "reference".
    """
    size, expected = _measure_misfit(problem, fit.values), _measure_misfit(problem, stated)
    if not size > DOUBTED * expected:
        return ""
    _, without = _find_most_likely(problem, stated, np.zeros((2, 2)))
    readings = _list_readings()
    words = max(
        readings, key=lambda reading: _scan_delays(problem, stated, readings[reading], COARSE)[1]
    )
    found, value = _find_most_likely(problem, stated, readings[words])
    best = _measure_misfit(problem, decode(found))
    if value < max(fit.log_likelihood, without) + EVIDENCE or SMALLER * best > size:
        words = ""
    start = (
        f"the specific force contradicts the {source}: its double integral misses them by "
        f"{size:.2g} m where the stated noise explains {expected:.2g} m"
    )
    if words:
        return f"{start}; with {words} it fits {size / best:.2g} times better"
    if without > fit.log_likelihood + EVIDENCE:
        return f"{start}; without the force they are explained better"
    return ""


def _measure_misfit(problem: Problem, values: Array) -> float:
    """Return how far a position lies from what its neighbours and the IMU say, m.

    It is the rms of the third differences, in units of that of white position noise of 1 m.
    """
    parts = problem.differences
    variance = (
        problem.integral.step * values[0] ** 2 * parts.of_white[0]
        + values[1] ** 2 * parts.of_position[0] + values[2] ** 2 * parts.of_walk[0]
    )  # fmt: skip
    return float(np.sqrt(np.mean(variance / parts.of_position[0])))
