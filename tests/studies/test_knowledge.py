"""What schemes are told is compared, and a scheme is prepared once for all that it is told."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from small_tower import SMALL_TOWER

from owtsweep.studies import compose, get_study
from owtsweep.studies.base.blocks import Records
from owtsweep.studies.base.schemes import Scheme, SchemeTable, Unable

#: A short record of each declared study; the buoy moves alike in every record.
SHORT = {
    "floater": ["record.duration=60", "record.rate=10", "record.settling=20"],
    "blade": ["record.duration=60", "record.settling=20", "grid.outage=[0]"],
    "tower": SMALL_TOWER,
}
BUOY = ["study=floater", "motion=decay", *SHORT["floater"]]


def tell(study: str, *words: str) -> list[Any]:
    """Return what schemes are told of all parts of two records of the first cell."""
    config: Any = compose([f"study={study}", *SHORT[study], *words])
    declaration = get_study(study).declaration()
    cell = declaration.axes.list_cells(config)[0]
    taken = Records(declaration, config, [0, 1]).take(config, cell)
    return [part.known for _, parts in taken for part in parts.values()]


@pytest.mark.parametrize("study", SHORT)
def test_what_is_told_of_a_record_equals_itself_made_anew_and_no_other_record(study: str) -> None:
    told, again = tell(study), tell(study)
    assert told == again
    assert [hash(known) for known in told] == [hash(known) for known in again]
    assert len(set(told)) == len(told)


def test_another_number_of_a_tuning_or_of_an_array_is_other_knowledge() -> None:
    told = tell("floater")[0]
    assert told != tell("floater", "filters.lag=0.9")[0]
    assert told != tell("floater", "grid.snr=[21]")[0]
    assert told != object()


class Counting(Scheme[Any, Any, Any]):
    """A scheme of the floater that counts what is asked of it, and is unable after that."""

    name = "KF"

    def __init__(self) -> None:
        self.asked: Counter[Any] = Counter()
        self.records = 0

    def prepare(self, known: Any) -> Counting:
        self.asked[known] += 1
        return self

    def run(self, measured: Any) -> Any:
        self.records += 1
        raise Unable("it only counts")


@pytest.mark.parametrize(("words", "distinct"), [(BUOY, 1), (["study=floater", *BUOY[2:]], 9)])
def test_a_block_prepares_a_scheme_once_for_each_distinct_knowledge(
    words: list[str], distinct: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scheme = Counting()
    monkeypatch.setattr(SchemeTable, "resolve", lambda table, entry: scheme)
    config = compose([*words, "schemes=[KF]", "grid.delay=[0]", "grid.bias=[0.1]",
                      "grid.replicates=9"])  # fmt: skip
    engine = get_study("floater").engine(config)
    blocks = engine.plan(config)
    assert len(list(engine.run(config, blocks))) == len(blocks) == 1
    assert scheme.records == 9
    assert list(scheme.asked.values()) == [1] * distinct


def test_what_a_scheme_is_unable_to_do_is_asked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    class Refusing(Counting):
        def prepare(self, known: Any) -> Counting:
            self.asked[known] += 1
            raise Unable("not on Sundays")

    scheme = Refusing()
    monkeypatch.setattr(SchemeTable, "resolve", lambda table, entry: scheme)
    config = compose(
        [*BUOY, "schemes=[KF]", "grid.delay=[0]", "grid.bias=[0.1]", "grid.replicates=10"]
    )
    engine = get_study("floater").engine(config)
    ((_, rows),) = engine.run(config, engine.plan(config))
    assert rows["reason"].tolist() == ["not on Sundays"] * 10
    assert list(scheme.asked.values()) == [1]
