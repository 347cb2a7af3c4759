"""Splits overrides with several values, e.g. `seed=1,2`, into one list of overrides per run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from owtsweep.config import Tree
from owtsweep.config.composition import quote_home, require_readable
from owtsweep.config.hints import hydra_in_one_line

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override


class Combination(NamedTuple):
    """The overrides of one run, and the run's values: key -> value, for keys with several."""

    overrides: list[str]
    values: dict[str, str]


def parse(overrides: Sequence[str], tree: Tree) -> list[Override]:
    """Return the overrides as objects of Hydra, without Hydra's own settings.

    Raises InputError if an override cannot be read.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser

    require_readable(overrides)
    with hydra_in_one_line(tree):
        parsed = OverridesParser.create().parse_overrides([quote_home(o) for o in overrides])
    return [override for override in parsed if not str(override.key_or_group).startswith("hydra")]


def list_swept(parsed: Sequence[Override]) -> list[str]:
    """Return the keys of the parsed overrides that give several values, in their order."""
    return [str(o.get_key_element()) for o in parsed if o.is_sweep_override()]


def count_runs(parsed: Sequence[Override]) -> float:
    """Return for how many runs parsed overrides ask; infinite if a range has no end.

    The values themselves are not made.
    """
    return math.prod(map(_count_values, parsed))


def _count_values(override: Override) -> float:
    from hydra.core.override_parser.types import ChoiceSweep, RangeSweep

    value = override.value()
    if isinstance(value, RangeSweep):
        if value.start is None or value.stop is None:
            return math.inf
        try:
            return float(max(math.ceil((value.stop - value.start) / value.step), 0))
        except (ArithmeticError, ValueError):  # a step of zero, an end that is infinite or NaN
            return math.inf
    return float(len(value.list)) if isinstance(value, ChoiceSweep) else 1.0


def combine(parsed: Sequence[Override], tree: Tree) -> list[Combination]:
    """Return the combinations of the values of parsed overrides, as Hydra's basic sweeper does.

    Raises InputError if the values cannot be listed.
    """
    from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

    with hydra_in_one_line(tree):
        batches = BasicSweeper.split_arguments(list(parsed), max_batch_size=None)
    swept = list_swept(parsed)
    combinations = []
    for words in (list(job) for batch in batches for job in batch):
        pairs = [word.partition("=")[::2] for word in words]
        values = {key: value for key, value in pairs if key in swept}
        combinations.append(Combination(words, values))
    return combinations
