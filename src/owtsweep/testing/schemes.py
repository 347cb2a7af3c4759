"""Checks that a scheme, also a user's, keeps the contract of a scheme.

    from owtsweep.testing import check_scheme

    def test_my_scheme():
        check_scheme(MyScheme())

If a scheme breaks the contract, the check raises `AssertionError` with one line that names the
broken part. The four schemes of the hub study pass these checks. The contract is in
`owtsweep.studies.hub.contract`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies import compose
from owtsweep.studies.hub.public import Scheme, Sensors, require_scheme, trajectories

#: IMU steps of a check: enough for several position fixes with each of `example_sensors()`.
STEPS = 64
#: Largest allowed difference of values that must be equal, relative to the largest magnitude.
TOLERANCE = 1e-9


def check_scheme(
    scheme: Scheme, *, tuning: Any = None, sensors: Iterable[Sensors] | None = None
) -> None:
    """Run all checks on a scheme.

    Parameters
    ----------
    scheme
        An object with `name`, `linear`, `start(sensors, tuning)` and perhaps `kernel`.
    tuning
        The argument `tuning` of `start`; if None, the configuration of the default study.
    sensors
        The sensors with which the scheme is checked, one after the other; if None,
        `example_sensors()`.

    Raises
    ------
    AssertionError
        If a check fails, with one line that names the scheme and the broken part of the contract.
    """
    check_declaration(scheme)
    if tuning is None:
        tuning = compose([])
    for example in example_sensors() if sensors is None else sensors:
        check_estimates(scheme, example, tuning)
        check_starts(scheme, example, tuning)
        check_inputs(scheme, example, tuning)
        if scheme.linear:
            check_superposition(scheme, example, tuning)
        if hasattr(scheme, "kernel"):
            check_kernel(scheme, example, tuning)


def example_sensors() -> list[Sensors]:
    """Return three `Sensors` that differ in rate, yaw and gravity.

    Their GNSS delays are zero, shorter than the interval between position fixes, and longer.
    """

    def sensors(
        rate: float, fix_interval: int, delay: int, yaw: float, gravity: tuple[float, float]
    ) -> Sensors:
        return Sensors(
            step=1.0 / rate, fix_interval=fix_interval, delay=delay, position_sigma=0.03,
            force_sigma=0.15, bias_walk=1e-3, yaw=yaw, gravity=gravity,
        )  # fmt: skip

    return [
        sensors(20.0, 20, 4, 0.0, (0.0, 0.0)),
        sensors(20.0, 10, 0, 0.6, (0.2, -0.1)),
        sensors(50.0, 25, 30, -2.5, (0.0, 0.3)),
    ]


def check_declaration(scheme: Any) -> None:
    """Check that a scheme has a name, a bool `linear` and a method `start`.

    Raises
    ------
    AssertionError
        If one of the three is missing.
    """
    try:
        require_scheme(scheme, type(scheme).__name__)
    except InputError as error:
        raise AssertionError(str(error)) from None


def check_estimates(scheme: Scheme, sensors: Sensors, tuning: Any) -> None:
    """Check that estimates are finite and have the right shapes, and that covariances are valid.

    A covariance is valid if it is symmetric and has no negative eigenvalue. If the scheme is
    linear, its estimate must also stay at zero when all data are zero.

    Raises
    ------
    AssertionError
        If an estimate breaks one of these rules.
    """
    for size in (1.0, 1e3):
        force, fixes = _data(sensors, size)
        for k, estimate in enumerate(_run(scheme, sensors, tuning, force, fixes)):
            where = f"{scheme.name}: the %s of step {k}"
            _finite(estimate.position, (2,), where % "position")
            _finite(estimate.velocity, (2,), where % "velocity")
            if estimate.covariance is not None:
                _covariance(estimate.covariance, 4, where % "covariance")
            if estimate.innovation is not None:
                _finite(estimate.innovation.value, (2,), where % "innovation")
                _covariance(estimate.innovation.covariance, 2, where % "innovation's covariance")
    if scheme.linear:
        zeros = _states(_run(scheme, sensors, tuning, np.zeros((STEPS, 2)), np.zeros((STEPS, 2))))
        assert not np.any(zeros), (
            f"{scheme.name}: it is linear, so with zero data the estimate must stay at zero; step "
            f"{int(np.argmax(np.any(zeros != 0.0, axis=1)))} gives {np.max(np.abs(zeros)):.2g}"
        )


def check_starts(scheme: Scheme, sensors: Sensors, tuning: Any) -> None:
    """Check that each call of `start` returns a new estimator, independent of all others.

    An estimator must give equal estimates whether it runs alone or beside another one.

    Raises
    ------
    AssertionError
        If `start` returns one estimator twice, or estimates depend on another estimator.
    """
    force, fixes = _data(sensors)
    alone = _states(_run(scheme, sensors, tuning, force, fixes))
    first, second = scheme.start(sensors, tuning), scheme.start(sensors, tuning)
    assert first is not second, f"{scheme.name}: start returns the same estimator twice"
    pair = np.empty((2, STEPS, 4))
    for k in range(STEPS):  # run two estimators in turn, the second on other data
        for i, (estimator, sign) in enumerate(((first, 1.0), (second, -2.0))):
            estimate = estimator.update(sign * force[k], _fix(sensors, sign * fixes, k))
            pair[i, k] = _state(estimate)
    assert np.array_equal(pair[0], alone), (
        f"{scheme.name}: an estimator started beside another one gives other estimates; keep all "
        "state in the estimator, none in the scheme or its class, and draw no random numbers"
    )


def check_inputs(scheme: Scheme, sensors: Sensors, tuning: Any) -> None:
    """Check that `update` neither changes its input arrays nor keeps references to them.

    Raises
    ------
    AssertionError
        If `update` changes an array, or estimates change when the caller reuses the arrays.
    """
    force, fixes = _data(sensors)
    expected = _states(_run(scheme, sensors, tuning, force, fixes))
    estimator = scheme.start(sensors, tuning)
    sample, position = np.empty(2), np.empty(2)
    reused = np.empty((STEPS, 4))
    for k in range(STEPS):
        sample[:] = force[k]
        fix = _fix(sensors, fixes, k)
        if fix is not None:
            position[:] = fix
        reused[k] = _state(estimator.update(sample, None if fix is None else position))
        untouched = np.array_equal(sample, force[k]) and (
            fix is None or np.array_equal(position, fix)
        )
        assert untouched, f"{scheme.name}: update changes the arrays that it is given (step {k})"
        position[:] = np.nan
    assert np.array_equal(reused, expected), (
        f"{scheme.name}: update keeps a reference to an array that it was given, and so sees the "
        "caller's next sample in it; keep a copy"
    )


def check_superposition(scheme: Scheme, sensors: Sensors, tuning: Any) -> None:
    """Check that a linear scheme's estimate for a sum of data is the sum of its estimates.

    Raises
    ------
    AssertionError
        If the two differ, or the estimate is always zero.
    """
    force_a, fixes_a = _data(sensors, seed=1)
    force_b, fixes_b = _data(sensors, seed=2)
    a = _states(_run(scheme, sensors, tuning, force_a, fixes_a))
    b = _states(_run(scheme, sensors, tuning, force_b, fixes_b))
    both = _states(_run(scheme, sensors, tuning, force_a + force_b, fixes_a + fixes_b))
    error = _relative(a + b, both)
    assert error <= TOLERANCE, (
        f"{scheme.name}: it says linear = True, but f(a) + f(b) differs from f(a + b) by "
        f"{error:.1e} of the estimate; set linear = False"
    )
    assert np.any(both), f"{scheme.name}: the estimate is zero whatever the data"


def check_kernel(scheme: Any, sensors: Sensors, tuning: Any) -> None:
    """Check that the scheme's kernel for the batch engine gives the estimates that `update` gives.

    Raises
    ------
    AssertionError
        If the two differ.
    """

    force, fixes = _data(sensors)
    expected = _states(_run(scheme, sensors, tuning, force, fixes))
    position, velocity, _ = trajectories(
        scheme.kernel(sensors, tuning, STEPS), sensors, force @ sensors.rotation.T, fixes
    )
    error = _relative(np.hstack([position, velocity]), expected)
    assert error <= TOLERANCE, (
        f"{scheme.name}: its kernel differs from update by {error:.1e} of the estimate"
    )


def _data(sensors: Sensors, size: float = 1.0, seed: int = 0) -> tuple[Array, Array]:
    """Draw normally distributed specific forces and positions, of the standard deviation `size`.

    Return the forces in the IMU's frame, shape (STEPS, 2), and the positions, one row per position
    fix and two columns.
    """
    random = np.random.default_rng(seed)
    fixes = -(-STEPS // sensors.fix_interval)
    return size * random.normal(size=(STEPS, 2)), size * random.normal(size=(fixes, 2))


def _fix(sensors: Sensors, fixes: Array, step: int) -> Array | None:
    """Return the position fix that arrives at a step, or None if none arrives."""
    number, since = divmod(step, sensors.fix_interval)
    return None if since else fixes[number]


def _run(
    scheme: Scheme, sensors: Sensors, tuning: Any, force: Array, fixes: Array
) -> list[Estimate]:
    estimator = scheme.start(sensors, tuning)
    return [
        estimator.update(sample.copy(), _fix(sensors, fixes.copy(), k))
        for k, sample in enumerate(force)
    ]


def _state(estimate: Estimate) -> Array:
    return np.concatenate([estimate.position, estimate.velocity])


def _states(estimates: list[Estimate]) -> Array:
    """Return position and velocity of all estimates, shape (steps, 4).

    The estimates are read after the run, so that an estimator that reuses its output is detected.
    """
    return np.array([_state(estimate) for estimate in estimates])


def _relative(actual: Array, expected: Array) -> float:
    largest = np.maximum(np.max(np.abs(expected), axis=0), np.finfo(float).tiny)
    return float(np.max(np.abs(actual - expected) / largest))


def _finite(value: Any, shape: tuple[int, ...], what: str) -> None:
    array = np.asarray(value, dtype=float)
    assert array.shape == shape, f"{what} has the shape {array.shape}, not {shape}"
    assert np.all(np.isfinite(array)), f"{what} is not finite"


def _covariance(value: Any, size: int, what: str) -> None:
    _finite(value, (size, size), what)
    P = np.asarray(value, dtype=float)
    largest = np.max(np.abs(P))
    assert np.allclose(P, P.T, rtol=0.0, atol=TOLERANCE * largest), f"{what} is not symmetric"
    least = float(np.min(np.linalg.eigvalsh(P)))
    assert least >= -TOLERANCE * largest, f"{what} has the negative eigenvalue {least:.2g}"
