"""Checks that a scheme of a declared study, e.g. a user's, keeps `owtsweep.studies.base.contract`.

from owtsweep.testing import check_declared_scheme

def test_my_scheme():
    check_declared_scheme(MyScheme(), "blade", ["record.duration=60"])
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import is_dataclass
from typing import Any

import numpy as np

from owtsweep.studies import compose, get_study
from owtsweep.studies.base.axes import list_cells
from owtsweep.studies.base.blocks import Records, check_estimates
from owtsweep.studies.base.contract import NotFinite, Unable
from owtsweep.studies.base.study import DeclaredStudy


def check_declared_scheme(scheme: Any, study: str, overrides: Sequence[str] = ()) -> None:
    """Run a scheme twice on a record of a study, and check what it returns.

    Parameters
    ----------
    scheme
        An object with `name` and `prepare(known)`, which returns an object with `run(measured)`.
    study
        The study's name: "blade", "floater" or "tower".
    overrides
        Hydra overrides, e.g. for a short record. The first cell of the grid is taken.

    Raises
    ------
    AssertionError
        If the scheme has no name; if an estimate is missing, not finite, or not of the declared
        shape; if a second run gives other estimates; or if measurements are changed. The message is
        one line. A scheme that says `Unable` passes.
    """
    found = get_study(study)
    assert isinstance(found, DeclaredStudy), f"study: {study!r} declares no estimates"
    declaration = found.declaration()
    config: Any = compose([f"study={study}", *overrides])
    name = getattr(scheme, "name", None)
    assert isinstance(name, str), f"{type(scheme).__name__} lacks name (a non-empty str)"
    assert name, f"{type(scheme).__name__} lacks name (a non-empty str)"
    cell = list_cells(declaration.contest.axes, config.grid)[0]
    ((record, parts),) = Records(declaration, config, [0]).take(config, cell)
    for part in parts.values():
        given = deepcopy(part.measured)
        try:
            first = scheme.prepare(part.known).run(given)
            second = scheme.prepare(part.known).run(deepcopy(part.measured))
        except Unable:
            continue
        assert _equal(given, part.measured), f"{name}: run changes the measurements"
        try:
            check_estimates(declaration, first, declaration.count_samples(record))
        except NotFinite as reason:
            raise AssertionError(f"{name}: {reason}") from None
        for field in declaration.estimates:
            one: Any = getattr(first, field, None)
            other: Any = getattr(second, field, None)
            assert one is other is None or np.array_equal(one, other, equal_nan=True), (
                f"{name}: {field} differs from run to run; keep no state in the scheme, and draw "
                "no random numbers"
            )


def _equal(one: Any, other: Any) -> bool:
    """Return whether two measurements, arrays or dataclasses of arrays, are equal bit for bit."""
    if not is_dataclass(one):
        return bool(np.array_equal(one, other, equal_nan=True))
    return all(
        np.array_equal(value, getattr(other, key), equal_nan=_is_float(value))
        for key, value in vars(one).items()
        if isinstance(value, np.ndarray)
    )


def _is_float(value: np.ndarray) -> bool:
    return np.issubdtype(value.dtype, np.floating)
