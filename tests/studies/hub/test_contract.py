"""The contract suite: our schemes and a user's pass it, and each broken one is found out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hold_last_fix import HoldLastFix, HoldLastFixEstimator
from tools import configure

from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.studies.hub.contract import resolve
from owtsweep.testing import check_scheme
from owtsweep.testing.hub_schemes import check_hub_scheme, example_sensors


def test_the_example_keeps_the_contract_with_the_default_tuning() -> None:
    check_scheme(HoldLastFix())


class Broken(HoldLastFix):
    """A scheme whose estimator or declaration is replaced."""

    def __init__(self, estimator: type | None = None, **declared: Any) -> None:
        self.estimator = estimator
        for key, value in declared.items():
            setattr(self, key, value)

    def start(self, known):
        return (self.estimator or HoldLastFixEstimator)(known.sensors.fix_step)


class Shape(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        estimate = super().update(specific_force, position)
        return estimate._replace(velocity=estimate.velocity[:, None])


class Nan(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        return super().update(specific_force, position)._replace(position=np.full(2, np.nan))


class Offset(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        estimate = super().update(specific_force, position)
        return estimate._replace(position=estimate.position + 1e-3)


class Clipped(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        estimate = super().update(specific_force, position)
        return estimate._replace(position=np.clip(estimate.position, -1.0, 1.0))


class Writes(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        specific_force *= 2.0
        return super().update(specific_force, position)


class Refers(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        self.last = self.last if position is None else position
        return Estimate(self.last, np.zeros(2))


class Shares(HoldLastFixEstimator):
    total = np.zeros(2)

    def update(self, specific_force, position=None):
        Shares.total = Shares.total + specific_force
        return Estimate(Shares.total, np.zeros(2))


class Random(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        return Estimate(specific_force * np.random.default_rng().random(), np.zeros(2))


class Negative(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        return super().update(specific_force, position)._replace(covariance=-np.eye(4))


class Asymmetric(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        P = np.eye(4)
        P[0, 1] = 0.5
        return super().update(specific_force, position)._replace(covariance=P)


class BadInnovation(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        innovation = Innovation(np.zeros(2), np.eye(4))
        return super().update(specific_force, position)._replace(innovation=innovation)


class Nothing(HoldLastFixEstimator):
    def update(self, specific_force, position=None):
        return Estimate(np.zeros(2), np.zeros(2))


@pytest.mark.parametrize(
    ("scheme", "message"),
    [
        (Broken(name=""), r"lacks name"),
        (Broken(linear=1), r"lacks linear"),
        (Broken(Shape), r"velocity of step 0 has the shape \(2, 1\), not \(2,\)"),
        (Broken(Nan), r"position of step 0 is not finite"),
        (Broken(Offset), r"zero data"),
        (Broken(Clipped), r"says linear = True"),
        (Broken(Writes), r"changes the arrays"),
        (Broken(Refers), r"keep a copy"),
        (Broken(Shares, linear=False), r"beside another one"),
        (Broken(Random, linear=False), r"beside another one"),
        (Broken(Negative), r"covariance of step 0 has the negative eigenvalue -1"),
        (Broken(Asymmetric), r"covariance of step 0 is not symmetric"),
        (Broken(BadInnovation), r"innovation's covariance of step 0 has the shape"),
        (Broken(Nothing), r"zero whatever the data"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_broken_schemes_are_found_out(scheme: Broken, message: str) -> None:
    with pytest.raises(AssertionError, match=message) as caught:
        check_scheme(scheme)
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("kernels")
def test_a_kernel_that_differs_is_found_out() -> None:
    class Lagging(type(resolve("MKF"))):
        def kernel(self, known, steps):
            sensors = replace(known.sensors, position_sigma=0.031)
            return super().kernel(replace(known, sensors=sensors), steps)

    config = configure(tuning="matched")
    check_hub_scheme(resolve("MKF"), config, example_sensors()[:1])
    with pytest.raises(AssertionError, match="kernel differs from update"):
        check_hub_scheme(Lagging("Lagging", "mkf"), config, example_sensors()[:1])


def test_a_nonlinear_scheme_may_saturate() -> None:
    check_scheme(Broken(Clipped, linear=False))
