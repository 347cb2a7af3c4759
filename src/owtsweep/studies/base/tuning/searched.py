"""What `tune` may search in a study: numbers of its tunings, and the schemes that have them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from owtsweep.studies.base.searching import Space


class Searched(NamedTuple):
    """Numbers that are searched together.

    schemes: All schemes that have them: the numbers shall serve all of them.
    space: Key of the configuration -> its bounds and its scale.
    counts: whether any estimate depends on the numbers under a configuration of one tuning.
    """

    schemes: Sequence[str]
    space: Space
    counts: Callable[[Any], bool] = lambda config: True
