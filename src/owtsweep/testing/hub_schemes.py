"""Checks that a scheme of the hub study keeps the contract in `owtsweep.studies.hub.contract`.

Each check runs estimators on random data and raises `AssertionError` if the contract is broken. The
message is one line that names the broken part.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.public import HubConfig, Known, Scheme, Sensors, trajectories

#: IMU steps of a check: enough for several fixes with each of `example_sensors()`.
STEPS = 64
#: Largest allowed difference of values that must be equal, relative to the largest magnitude.
TOLERANCE = 1e-9
#: Natural period (s) and amplitude (m) of the motion that a scheme knows if it must.
MOTION = (4.0, 1.0)


def check_hub_scheme(
    scheme: Scheme, config: HubConfig, sensors: Iterable[Sensors] | None = None
) -> None:
    """Run all checks on a scheme with each of `sensors`, by default `example_sensors()`.

    `config` has one tuning. Raise `AssertionError` if a check fails.
    """
    for example in example_sensors() if sensors is None else sensors:
        known = Known(example, config, *MOTION) if scheme.knows_motion else Known(example, config)
        check_estimates(scheme, known)
        check_starts(scheme, known)
        check_inputs(scheme, known)
        if scheme.linear:
            check_superposition(scheme, known)
        if scheme.batched == "chain":
            check_kernel(scheme, known)


def example_sensors() -> list[Sensors]:
    """Return three sets of sensor parameters, which differ in GNSS delay, yaw and gravity.

    The delay is shorter than the interval between fixes in the first set, zero in the second, and
    longer than this interval in the third. The IMU rate is 20, 20 and 50 Hz.
    """

    sensors = partial(Sensors, position_sigma=0.03, force_sigma=0.15, bias_walk=1e-3)
    return [
        sensors(step=0.05, fix_interval=20, delay=4, yaw=0.0, gravity=(0.0, 0.0)),
        sensors(step=0.05, fix_interval=10, delay=0, yaw=0.6, gravity=(0.2, -0.1)),
        sensors(step=0.02, fix_interval=25, delay=30, yaw=-2.5, gravity=(0.0, 0.3)),
    ]


def check_estimates(scheme: Scheme, known: Known) -> None:
    """Check that estimates are finite and have the right shapes, and that covariances are valid.

    A covariance is valid if it is symmetric and has no negative eigenvalue. A linear scheme's
    estimate must also stay at zero while all measurements are zero. Raise `AssertionError` if an
    estimate breaks one of these rules.
    """
    for size in (1.0, 1e3):
        force, fixes = _data(known.sensors, size)
        for k, estimate in enumerate(_run(scheme, known, force, fixes)):
            where = f"{scheme.name}: the %s of step {k}"
            _finite(estimate.position, (2,), where % "position")
            _finite(estimate.velocity, (2,), where % "velocity")
            if estimate.covariance is not None:
                _covariance(estimate.covariance, 4, where % "covariance")
            if estimate.innovation is not None:
                _finite(estimate.innovation.value, (2,), where % "innovation")
                _covariance(estimate.innovation.covariance, 2, where % "innovation's covariance")
    if scheme.linear:
        zeros = _states(_run(scheme, known, np.zeros((STEPS, 2)), np.zeros((STEPS, 2))))
        assert not np.any(zeros), (
            f"{scheme.name}: it is linear, so with zero data the estimate must stay at zero; step "
            f"{int(np.argmax(np.any(zeros != 0.0, axis=1)))} gives {np.max(np.abs(zeros)):.2g}"
        )


def check_starts(scheme: Scheme, known: Known) -> None:
    """Check that each call of a scheme's `start` returns a new, independent estimator.

    Raise `AssertionError` if `start` returns the same estimator twice, or if another estimator, run
    in turn with it, changes the estimates.
    """
    force, fixes = _data(known.sensors)
    alone = _states(_run(scheme, known, force, fixes))
    first, second = scheme.start(known), scheme.start(known)
    assert first is not second, f"{scheme.name}: start returns the same estimator twice"
    pair = np.empty((2, STEPS, 4))
    for k in range(STEPS):  # run two estimators in turn, the second on other data
        for i, (estimator, sign) in enumerate(((first, 1.0), (second, -2.0))):
            estimate = estimator.update(sign * force[k], _fix(known.sensors, sign * fixes, k))
            pair[i, k] = _state(estimate)
    assert np.array_equal(pair[0], alone), (
        f"{scheme.name}: an estimator started beside another one gives other estimates; keep all "
        "state in the estimator, none in the scheme or its class, and draw no random numbers"
    )


def check_inputs(scheme: Scheme, known: Known) -> None:
    """Check that an estimator's `update` neither changes nor keeps the arrays that it is given.

    Raise `AssertionError` if `update` changes an array, or if estimates change when the caller
    reuses the arrays.
    """
    force, fixes = _data(known.sensors)
    expected = _states(_run(scheme, known, force, fixes))
    estimator = scheme.start(known)
    sample, position = np.empty(2), np.empty(2)
    reused = np.empty((STEPS, 4))
    for k in range(STEPS):
        sample[:] = force[k]
        fix = _fix(known.sensors, fixes, k)
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


def check_superposition(scheme: Scheme, known: Known) -> None:
    """Check that a linear scheme's estimate for a sum of data is the sum of the estimates.

    Raise `AssertionError` if it is not, or is always zero.
    """
    force_a, fixes_a = _data(known.sensors, seed=1)
    force_b, fixes_b = _data(known.sensors, seed=2)
    a = _states(_run(scheme, known, force_a, fixes_a))
    b = _states(_run(scheme, known, force_b, fixes_b))
    both = _states(_run(scheme, known, force_a + force_b, fixes_a + fixes_b))
    error = _relative(a + b, both)
    assert error <= TOLERANCE, (
        f"{scheme.name}: it says linear = True, but f(a) + f(b) differs from f(a + b) by "
        f"{error:.1e} of the estimate; set linear = False"
    )
    assert np.any(both), f"{scheme.name}: the estimate is zero whatever the data"


def check_kernel(scheme: Scheme, known: Known) -> None:
    """Check that a scheme's kernel for the batch engine gives the estimates that `update` gives.

    Raise `AssertionError` if it does not.
    """

    force, fixes = _data(known.sensors)
    expected = _states(_run(scheme, known, force, fixes))
    turned = force @ known.sensors.rotation.T
    position, velocity, _ = trajectories(scheme.kernel(known, STEPS), turned, fixes)
    error = _relative(np.hstack([position, velocity]), expected)
    assert error <= TOLERANCE, (
        f"{scheme.name}: its kernel differs from update by {error:.1e} of the estimate"
    )


def _data(sensors: Sensors, size: float = 1.0, seed: int = 0) -> tuple[Array, Array]:
    """Draw specific forces in the IMU's frame, shape (STEPS, 2), and fixes, shape (fixes, 2)."""
    random = np.random.default_rng(seed)
    fixes = -(-STEPS // sensors.fix_interval)
    return size * random.normal(size=(STEPS, 2)), size * random.normal(size=(fixes, 2))


def _fix(sensors: Sensors, fixes: Array, step: int) -> Array | None:
    """Return the fix, shape (2,), that arrives at a step, if any."""
    number, since = divmod(step, sensors.fix_interval)
    return None if since else fixes[number]


def _run(scheme: Scheme, known: Known, force: Array, fixes: Array) -> list[Estimate]:
    estimator = scheme.start(known)
    return [
        estimator.update(sample.copy(), _fix(known.sensors, fixes.copy(), k))
        for k, sample in enumerate(force)
    ]


def _state(estimate: Estimate) -> Array:
    return np.concatenate([estimate.position, estimate.velocity])


def _states(estimates: list[Estimate]) -> Array:
    """Return position and velocity of all estimates, shape (steps, 4).

    Call this after all updates: an estimator that writes every estimate into the same array is then
    detected.
    """
    return np.array([_state(estimate) for estimate in estimates])


def _relative(actual: Array, expected: Array) -> float:
    largest = np.maximum(np.max(np.abs(expected), axis=0), np.finfo(float).tiny)
    return float(np.max(np.abs(actual - expected) / largest))


def _finite(value: object, shape: tuple[int, ...], what: str) -> None:
    array = np.asarray(value, dtype=float)
    assert array.shape == shape, f"{what} has the shape {array.shape}, not {shape}"
    assert np.all(np.isfinite(array)), f"{what} is not finite"


def _covariance(value: object, size: int, what: str) -> None:
    _finite(value, (size, size), what)
    P = np.asarray(value, dtype=float)
    largest = np.max(np.abs(P))
    assert np.allclose(P, P.T, rtol=0.0, atol=TOLERANCE * largest), f"{what} is not symmetric"
    least = float(np.min(np.linalg.eigvalsh(P)))
    assert least >= -TOLERANCE * largest, f"{what} has the negative eigenvalue {least:.2g}"
