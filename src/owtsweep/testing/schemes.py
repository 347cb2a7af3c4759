"""Checks that a scheme, e.g. a user's, keeps the contract of its study.

from owtsweep.testing import check_scheme

def test_my_scheme():
    check_scheme(MyScheme(), ["record.duration=60"])
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from typing import Any

from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.studies.base.blocks import Records, check_estimates
from owtsweep.studies.base.schemes import NotFinite, Scheme, Unable, identify
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.studies.hub import public as hub
from owtsweep.testing.hub_schemes import check_hub_scheme


def check_scheme(scheme: Scheme[Any, Any, Any], overrides: Sequence[str] = ()) -> None:
    """Check a scheme of any study: what it states of itself, and its estimates.

    A scheme of the hub runs step by step on random data, with several sets of sensors; another one
    runs twice on a record of the first cell of the grid. A scheme that says `Unable` passes. Raise
    `AssertionError` if the scheme states something wrong of itself; if an estimate is missing, not
    finite, or not of the declared shape; if a second run gives other estimates; if measurements are
    changed; or if a scheme of the hub that says so is not linear, or its kernel has other estimates
    than its estimator. The message is one line.

    scheme: the scheme, which derives from `owtsweep.schemes.<study>.Scheme`.
    overrides: Hydra overrides of its study, e.g. a tuning, or a short record.

    >>> import numpy as np
    >>> from owtsweep import Estimate
    >>> from owtsweep.schemes import hub
    >>> class Still(hub.Scheme):
    ...     name = "STILL"
    ...     def start(self, known):
    ...         return self
    ...     def update(self, specific_force, position=None):
    ...         return Estimate(np.zeros(2), np.zeros(2))
    >>> check_scheme(Still())
    Traceback (most recent call last):
    AssertionError: STILL: start returns the same estimator twice
    """
    try:
        scheme.check_declared()
    except InputError as error:
        raise AssertionError(f"{type(scheme).__name__}: {error}") from None
    config: Any = compose([f"study={scheme.study}", *overrides])
    if isinstance(scheme, hub.Scheme):
        check_hub_scheme(scheme, config)
    else:
        _check_on_record(scheme, config)


def _check_on_record(scheme: Scheme[Any, Any, Any], config: Any) -> None:
    found = get_study(scheme.study)
    assert isinstance(found, DeclaredStudy), f"study: {scheme.study!r} declares no estimates"
    declaration, name = found.declaration(), scheme.name
    cell = declaration.axes.list_cells(config)[0]
    ((record, parts),) = Records(declaration, config, [0]).take(config, cell)
    for part in parts.values():
        given = deepcopy(part.measured)
        try:
            first = scheme.prepare(part.known).run(given)
            second = scheme.prepare(part.known).run(deepcopy(part.measured))
        except Unable:
            continue
        unchanged = identify(given) == identify(part.measured)
        assert unchanged, f"{name}: run changes the measurements"
        try:
            for each in (first, second):
                check_estimates(declaration, each, declaration.count_samples(record))
        except NotFinite as reason:
            raise AssertionError(f"{name}: {reason}") from None
        for field in declaration.estimates:
            assert identify(getattr(first, field)) == identify(getattr(second, field)), (
                f"{name}: {field} differs from run to run; keep no state in the scheme, and draw "
                "no random numbers"
            )
