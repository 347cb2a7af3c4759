"""What is a study's own in a contest: axes, measures, costs, and how it describes its records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import Criterion
from owtsweep.statistics.deciding import ENOUGH
from owtsweep.studies.base.axes import Axes
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd


#: The measure of latency, s; only of schemes that look ahead.
WAIT = "wait"
#: The only window: after the settling time.
WINDOW = "settled"


C = TypeVar("C", bound=ContestConfig)


class Costs(NamedTuple):
    """Measured computing times of a study on one core, without compilation.

    record: Time of a record, with its measurements and what is known of it, s per sample.
    schemes: Name -> time of a record, s per sample.
    memory: What a process takes, bytes.
    """

    record: float
    schemes: Mapping[str, float]
    memory: float


@dataclass(frozen=True, kw_only=True)
class Contest(Axes[C]):
    """What is a study's own in a contest.

    criteria: the measures by which schemes are judged.
    measures: the order of measures in tables; others follow by name.
    describe_truth, describe_sensors: Say in words what a configuration's motion and sensors are.
    pairing: the keys on which the motion of a record depends, besides its conditions and number.
    ties_from: Number of records from which on a tie may be called.
    tell_more: Returns further lines for the terminal, of a configuration and its tables.
    costs: Measured computing times; None: nobody has measured them.
    """

    conditions: tuple[Condition, ...]
    criteria: Mapping[str, Criterion]
    measures: Sequence[str]
    describe_truth: Callable[[C], str]
    describe_sensors: Callable[[C], str]
    pairing: Sequence[str]
    ties_from: int = ENOUGH
    tell_more: Callable[[C, Mapping[str, pd.DataFrame]], list[str]] = lambda config, tables: []
    costs: Costs | None = None


#: The contest of any study: its functions take the configuration of that study alone.
AnyContest = Contest[Any]


def tell_single(
    conditions: Iterable[Condition], config: Any, usual: Mapping[str, object] = MappingProxyType({})
) -> list[str]:
    """Return in words the conditions with one value, but those that are as `usual`: name -> value.

    `config` has the section `grid`, and `axes`: the names of the conditions with several values.
    """
    words = []
    for condition in conditions:
        values = getattr(config.grid, condition.name)
        if condition.name not in config.axes and values and values[0] != usual.get(condition.name):
            words.append(f"{condition.label} {condition.show(values[0])}")
    return words


def describe_draws(config: ContestConfig) -> str:
    """Return in words how many records a cell has, and their seed."""
    return f"{config.grid.describe_records()}, seed {config.seed}"


def describe_origin(contest: Contest[C], config: C) -> str:
    """Return in one line the tuning, the truth, the sensors, the records and their seed."""
    origin = list_origin(contest, config)
    return (
        f"Tuning {origin['tuning']}; truth: {origin['truth']}; sensors: {origin['sensors']}; "
        f"{describe_draws(config)}"
    )


def list_origin(contest: Contest[C], config: C) -> dict[str, str]:
    """Return what a reader must know of a run: its name -> in words."""
    return {
        "tuning": config.tuning_name,
        "truth": contest.describe_truth(config),
        "sensors": contest.describe_sensors(config),
        "records per cell": config.grid.count_records(),
        "seed": str(config.seed),
    }


def predict(
    costs: Costs, blocks: Sequence[Block], samples: int, workers: int
) -> tuple[float, float] | None:
    """Return the computing time of blocks in s, and the memory in bytes, as `Engine.predict`.

    None if a scheme, such as a user's, has no measured time. `samples` are those of a record.
    """
    if any(block.content["scheme"] not in costs.schemes for block in blocks):
        return None
    records = {block.group: count_records(block) for block in blocks}  # shared by its schemes
    each = sum(costs.schemes[block.content["scheme"]] * count_records(block) for block in blocks)
    seconds = samples * (costs.record * sum(records.values()) + each)
    return seconds, costs.memory * (workers + 1)  # the sweep's own process, and its workers'


def count_records(block: Block) -> int:
    """Return how many records a block has."""
    first, stop = block.content["replicates"]
    return int(stop) - int(first)
