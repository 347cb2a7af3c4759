"""Judge statements: compare what claims select from tables of scores with their bounds.

`claims_file` tells how claims are written, and what each kind compares.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product
from string import Template

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.contest import find_alike, find_least
from owtsweep.statistics.contrasts import gap
from owtsweep.statistics.inference import mean_and_error
from owtsweep.verdicts.claims_file import ClaimsFile, Part, StatedClaim, Statement
from owtsweep.verdicts.inference import (
    Decision,
    Estimate,
    JudgedClaim,
    JudgedStatement,
    Side,
    count_errors,
    mean_ratio,
)
from owtsweep.verdicts.score_table import Cell, ScoreTable, Value

#: What can be made of values, as `claims_file.OF` lists it.
OF: dict[str, Callable[[Array], Array]] = {
    "identity": lambda values: values,
    "one_minus": lambda values: 1.0 - values,
    "abs": np.abs,
    "inverse": lambda values: 1.0 / values,
    "positive_part": lambda values: np.maximum(values, 0.0),
}
#: What is compared: its place in words, and the decision, or None where the scores lack it.
Compared = tuple[str, Decision | None]


def judge(
    statements: Sequence[Statement], tables: Sequence[ScoreTable], file: ClaimsFile
) -> list[JudgedStatement]:
    """Judge statements, each claim by the first table that has its columns.

    `file`, where they come from, has words for values, and names the script that makes scores which
    no table has. Raise `InputError` if a claim selects several scores where it means one.
    """
    return [
        JudgedStatement(
            statement.name,
            statement.text,
            statement.definition,
            tuple(_judge_claim(claim, tables, file) for claim in statement.claims),
        )
        for statement in statements
    ]


def list_beyond(statements: Sequence[Statement], tables: Sequence[ScoreTable]) -> list[str]:
    """Return the names of statements of which no table has the columns of some claim."""
    return [
        statement.name
        for statement in statements
        if any(
            part.kind != "not_judged" and _choose_table(part, tables) is None
            for claim in statement.claims
            for part in claim.parts
        )
    ]


def _choose_table(part: Part, tables: Sequence[ScoreTable]) -> ScoreTable | None:
    return next((table for table in tables if part.columns <= set(table.columns)), None)


def _judge_claim(claim: StatedClaim, tables: Sequence[ScoreTable], file: ClaimsFile) -> JudgedClaim:
    found: list[Compared] = []
    for part in claim.parts:
        if part.kind == "not_judged":
            found.append((claim.reason, None))
            continue
        table = _choose_table(part, tables)
        if table is None:
            found.append((f"scores of python -m {file.script}" if file.script else "scores", None))
        else:
            found += KINDS[part.kind](Task(part, table, file.words))
    decisions = [decision for _, decision in found if decision is not None]
    missing = dict.fromkeys(name for name, decision in found if decision is None)
    return JudgedClaim(claim.text, tuple(decisions), tuple(missing))


@dataclass(frozen=True)
class Task:
    """A part of a claim with the table by which it is judged, and words for values of columns."""

    part: Part
    table: ScoreTable
    words: Mapping[str, str]

    @property
    def cells(self) -> list[dict[str, Value]]:
        """The selected cells."""
        return self.table.list_cells(self.part.select)

    def pair(self, cells: Sequence[Cell]) -> Iterator[tuple[Cell, Cell]]:
        """Yield each cell with each that it is compared with."""
        against = self.part.against
        if isinstance(against, str):
            others = [{against: value} for value in self.part.select[against]]
        else:
            others = [dict(zip(against, v, strict=True)) for v in product(*against.values())]
        for cell in cells:
            for other in others:
                if cell | other != cell:
                    yield cell, cell | other

    def group(self) -> list[list[Cell]]:
        """Return the selected cells in groups that differ in the column `against` only."""
        column = str(self.part.against)
        values = self.part.select[column]
        first = self.table.list_cells(self.part.select | {column: values[:1]})
        return [[cell | {column: value} for value in values] for cell in first]

    def transform(self, values: Array) -> Array:
        """Return what the claim compares of values."""
        for name in self.part.of:
            values = OF[name](values)
        return values

    def tell(self, cell: Cell, other: Cell | None = None) -> str:
        """Tell a cell, or a pair of cells, in words."""
        one = self._tell(cell)
        if other is None:
            return one
        if one != (two := self._tell(other)):
            return f"{one} / {two}"
        apart = [name for name in cell if cell[name] != other[name]]
        sides = [" ".join(self._show(side[name]) for name in apart) for side in (cell, other)]
        return f"{one}: {sides[0]} / {sides[1]}" if apart else one

    def _tell(self, cell: Cell) -> str:
        shown = {name: self._show(value) for name, value in cell.items()}
        if self.part.label:
            return Template(self.part.label).safe_substitute(shown)
        return ", ".join(shown[name] for name in self.part.select)

    def _show(self, value: Value) -> str:
        text = str(value).lower() if isinstance(value, bool) else str(value)
        text = f"{value:g}" if isinstance(value, float) else text
        return self.words.get(text, text)

    def compare_means(self, name: str, found: Sequence[Array] | None) -> Compared:
        """Decide on the ratio of two means; None where the scores lack them."""
        if found is None:
            return name, None
        one, other = found
        return name, mean_ratio(name, one, other, self.part.bound, self.part.side)


def _compare_records(
    task: Task, groups: Iterable[Sequence[Cell]], combine: Callable[..., Array]
) -> list[Compared]:
    """Decide on the mean of one value per record, made of those of the cells of each group.

    None where a value is not finite.
    """
    part = task.part
    signed = combine is np.subtract and part.of == ("identity",)
    found: list[Compared] = []
    for cells in groups:
        name, samples = task.tell(*cells), task.table.find(cells)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = None if samples is None else task.transform(combine(*samples))
        if values is None or not np.all(np.isfinite(values)):
            found.append((name, None))
        elif part.exact:
            mean = float(np.mean(values))
            number = Estimate(f"{name}, one record", mean, mean, mean)
            found.append((name, number.against(part.bound, part.side)))
        elif signed:
            found.append((name, _test_mean(name, values, part.bound, part.side)))
        else:
            found.append((name, mean_ratio(name, values, 1.0, part.bound, part.side)))
    if part.exact:  # all are equally sure: the number that is furthest from holding comes first
        sign = -1.0 if part.side == "below" else 1.0
        found.sort(key=lambda one: sign * one[1].value if one[1] else np.inf)
    return found


def _test_mean(name: str, values: Array, bound: float, side: Side) -> Decision:
    found, (_, error, _) = gap(values - bound), mean_and_error(values - bound)
    sign = 1.0 if side == "above" else -1.0
    t = count_errors(sign * float(found.value), float(error))
    value, low, high = (float(each) + bound for each in found[:3])
    return Decision(name, value, low, high, bound, side, t, float(found.p))


def _ratio_of_means(task: Task) -> Iterator[Compared]:
    for pair in task.pair(task.cells):
        found = task.table.find(pair)
        yield task.compare_means(task.tell(*(pair if found else pair[:1])), found)


def _monotone(task: Task) -> Iterator[Compared]:
    for group in task.group():
        for before, cell in pairwise(group):
            yield task.compare_means(task.tell(cell, before), task.table.find([cell, before]))


def _against_best(task: Task) -> Iterator[Compared]:
    for cell in task.cells:
        cells = [cell, *(other for _, other in task.pair([cell]))]
        found = task.table.find(cells)
        best = None if found is None else find_best(found, other_than=0)
        if found is None or best is None:
            yield task.tell(cell), None
        else:
            yield task.compare_means(task.tell(cell, cells[best]), [found[0], found[best]])


def _nearly_equal(task: Task) -> Iterator[Compared]:
    for group in task.group():
        found = task.table.find(group)
        if found is None:
            yield task.tell(group[0]), None
            continue
        order = sorted(range(len(group)), key=lambda i: float(np.mean(found[i])))
        ends = order[0], order[-1]
        name = task.tell(*(group[i] for i in ends))
        yield task.compare_means(name, [found[i] for i in ends])


def _compare_boundaries(task: Task, *, grows: bool) -> Iterator[Compared]:
    run = task.table.run
    if run is None:
        yield "rows that hold for all values of the last condition", None
        return
    *outer, last = [condition.name for condition in run.conditions]
    for cell, other in task.pair(task.table.list_cells(task.part.select, free=[last])):
        schemes, measure = (str(cell["scheme"]), str(other["scheme"])), str(cell["measure"])
        here, there = (tuple(side[name] for name in outer) for side in (cell, other))
        found: Estimate | None
        if grows:
            found = run.divide((here, there), schemes, measure)
        else:
            found = run.find_boundaries(schemes, measure).get(here)
        over = f" over that at {run.tell(there)}" if grows else ""
        decision = None if found is None else found.against(task.part.bound, task.part.side)
        yield f"boundary at {run.tell(here)}{over}", decision


def find_best(values: Sequence[Array], *, other_than: int | None = None) -> int | None:
    """Return which array, shape (records,), has the least mean.

    Two coincide if they agree in every record. If the best coincide, it is the last of them. None
    if `other_than`, which is left out with all that coincide with it, leaves none.
    """
    everyone = np.ones((len(values), 1), dtype=bool)
    means = np.array([[np.mean(one)] for one in values])
    stacked = np.array(values)[:, np.newaxis]
    alike = find_alike(stacked, everyone, np.ones(stacked.shape[1:], dtype=bool))
    chosen = everyone if other_than is None else ~alike[other_than]
    return int(find_least(means, chosen, alike)[0][0]) if chosen.any() else None


KINDS: dict[str, Callable[[Task], Sequence[Compared] | Iterator[Compared]]] = {
    "bound": lambda task: _compare_records(task, [[cell] for cell in task.cells], np.asarray),
    "ratio": lambda task: _compare_records(task, task.pair(task.cells), np.divide),
    "spread": lambda task: _compare_records(task, task.pair(task.cells), np.divide),
    "difference": lambda task: _compare_records(task, task.pair(task.cells), np.subtract),
    "ratio_of_means": _ratio_of_means, "against_best": _against_best,
    "nearly_equal": _nearly_equal, "monotone": _monotone,
    "boundary": partial(_compare_boundaries, grows=False),
    "growth": partial(_compare_boundaries, grows=True),
}  # fmt: skip
