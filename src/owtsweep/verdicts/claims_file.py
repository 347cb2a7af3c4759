"""Read what a paper says about its results, as data: statements, and the claims that they make.

A file of claims is TOML. It is read, never evaluated. It judges tables of scores: long tables with
columns of conditions (and scheme, quantity, measure, scenario, whatever the study has), `replicate`
and `value` (`score_table.ScoreTable`).

    study = "hub"                        # whose runs it is about
    paper = "Ren et al. (2019)"
    script = "experiments.ren2019.fidelity"   # makes the scores that the rows of a run are not
    note = "Definitions were written down before any run was judged by them."
    label = "$natural_period s, $amplitude m"
    select = { measure = "position" }    # fields of claims that stand here serve the whole file
    words = { dense_x_a = "Dense: x-a" } # value -> how labels tell it

    [[statements]]                       # or [[goals]]: what the project itself wants to reach
    name = "F8"
    text = "the velocity estimate of HME2 is slightly better than that of HME1"
    printed = "section 5.4"              # where
    definition = "HME2 / HME1 of the velocity MSE at the conditions of tables 6-9: below 1 at all."
    decided = "..."                      # after data had been seen; may be left out
    [[statements.claims]]
    text = "HME2's velocity is better than HME1's at tables 6-9"
    reason = "better is below 1; how much `slightly` is, the paper does not say"
    kind = "ratio_of_means"
    select = { scheme = "HME2", measure = "velocity" }
    against = { scheme = "HME1" }
    side = "below"
    bound = 1.0
    parts = [
        { select = { natural_period = [4.0, 8.0], amplitude = 0.2 } },
        { select = { natural_period = 8.0, amplitude = 1.0 } },
        { select = { natural_period = 3.0, amplitude = 2.0 } },
    ]

A statement is true if all its claims are, a claim if all its comparisons are (with Holm's
correction over them). `parts` are for comparisons of one claim that no product of lists gives.

**Fields of claims**: `kind`, `select`, `against`, `of`, `side`, `bound`, `reason`, `exact`,
`label`. Each may stand in the file, in a statement, in a claim or in a part: the innermost counts.
`select` and `against` are joined column by column.

- `select`: column -> a value, or a list of values, which means all of them; of several lists, all
  combinations. "*" means all values that the table has beside what else is selected. A column that
  is left out must have one value in the whole table. A claim is judged by the first table that has
  all columns that it names. What depends on a look at the scores (which welds count, which motion
  is slow) is no selection: `scores.py` gives it a measure of its own.
- `against`: the columns in which the other side differs, with its values. For "nearly_equal",
  "spread" and "monotone" the name of a column: the other values of that column in `select`.
- `of`: what is made of the values, in this order: "identity", "one_minus", "abs", "inverse",
  "positive_part", or a list, e.g. ["one_minus", "abs"] for the distance from 1.
- `side`, `bound`: the quantity lies "below" or "above" this number.
- `reason`: why this bound; of "not_judged", why it is not.
- `exact`: true for a number that is known without an interval, e.g. of the author's only record.
- `label`: how a place is told, with $column for its value. By default, all selected values.

**Kinds.** Values are one per record; only records that have all that is compared count. Unless
another test is named, the paired t test of the mean is used, whose interval does not end below 0.

- "bound": the mean of `of`(values).
- "ratio": the mean of `of`(a / b) over the records, with the ratio taken in each record.
- "difference": the mean of `of`(a - b); without `of` it may have any sign.
- "ratio_of_means": mean(a) / mean(b), interval by Fieller.
- "against_best": mean(a) / mean(b), where b is what has the least mean of all that `against` lists
  in this place, but for what coincides with a in every record.
- "nearly_equal": least / largest mean of the values that `select` lists in the column `against`.
- "spread": as "ratio", every one over every other of them.
- "monotone": as "ratio_of_means", each of them over the one listed before.
- "boundary": of a run whose rows hold for all values of the last condition (the amplitude): the
  value below which the scheme in `select` is better, and above which that in `against`, with a
  bootstrapped interval. `select` names the other conditions.
- "growth": the boundary in the place of `select` over that in the place of `against`.
- "not_judged": nothing; the statement stays "missing".

Verdicts: "reproduced" if the data show that all comparisons hold, "not reproduced" if they show
that one does not, "missing" if the table lacks what is compared, else "undecided".
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar, cast

from owtsweep.config import Plain
from owtsweep.config.hints import suggest_name
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text
from owtsweep.verdicts.inference import Side
from owtsweep.verdicts.score_table import Selection, Value, tidy

T = TypeVar("T", str, bool, Plain)

#: Most bytes of a file, and most comparisons of a claim.
MOST_BYTES, MOST_COMPARISONS = 1_000_000, 100_000
#: Kind -> what `against` must be: nothing, values of columns, or the name of a column.
KINDS: dict[str, type | None] = {
    "bound": None, "ratio": dict, "difference": dict, "ratio_of_means": dict, "against_best": dict,
    "nearly_equal": str, "spread": str, "monotone": str, "boundary": dict, "growth": dict,
    "not_judged": None,
}  # fmt: skip
#: What can be made of values; `judge` has the functions.
OF = ("identity", "one_minus", "abs", "inverse", "positive_part")
FIELDS = ("kind", "select", "against", "of", "side", "bound", "reason", "exact", "label")
_OF_STATEMENT = ("name", "text", "printed", "definition", "decided", "claims", *FIELDS)
_OF_FILE = ("study", "paper", "script", "note", "words", "statements", "goals", *FIELDS)


@dataclass(frozen=True, kw_only=True)
class Part:
    """Comparisons of one kind; the module tells the meaning of each attribute."""

    kind: str
    select: Selection
    against: Selection | str
    of: tuple[str, ...]
    side: Side
    bound: float
    exact: bool
    label: str

    @property
    def columns(self) -> set[str]:
        """The names of all columns that are compared."""
        beside = {self.against} if isinstance(self.against, str) else set(self.against)
        return set(self.select) | (beside - {""})


@dataclass(frozen=True)
class StatedClaim:
    """A claim of a statement, and the reason of its bounds."""

    text: str
    reason: str
    parts: tuple[Part, ...]


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A statement of a paper, or a goal.

    name, text: E.g. "F1", and what the paper says.
    printed: where it is printed.
    definition: the test in words.
    decided: What was decided after data had been seen; "" if nothing was.
    """

    name: str
    text: str
    printed: str
    definition: str
    decided: str
    claims: tuple[StatedClaim, ...]


@dataclass(frozen=True, kw_only=True)
class ClaimsFile:
    """The content of a file of claims.

    `study`, `paper`, `script`, `note`: name of the study, name of the paper, module that makes
    scores which the rows of a run are not, and a sentence on the origin of the tests; "" where the
    file says nothing. `words`: value of a column -> how labels tell it. `statements`, `goals`: what
    the paper says, and what the project wants to reach.
    """

    study: str
    paper: str
    script: str
    note: str
    words: Mapping[str, str]
    statements: tuple[Statement, ...]
    goals: tuple[Statement, ...]


def read_claims(path: Path) -> ClaimsFile:
    """Read a file of claims.

    Raise `InputError` if the file cannot be read, is larger than 1 MB, is no TOML, or holds an
    unknown key or kind or a value that does not fit.
    """
    text = read_text(path, MOST_BYTES)
    try:
        found = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = "it nests too deeply" if isinstance(error, RecursionError) else str(error)
        raise InputError(f"{path}: this is no TOML ({reason})") from None
    where = str(path)
    _check_keys(found, _OF_FILE, where)
    shared = {name: found[name] for name in FIELDS if name in found}
    words = _take(found, "words", dict, where, {})
    require(
        all(isinstance(word, str) for word in words.values()),
        f"{where}: words: a word is no text; write value = text",
    )
    statements, goals = (
        tuple(
            _make_statement(one, shared, f"{where}: {name} {number}")
            for number, one in enumerate(_take_tables(found, name, where), 1)
        )
        for name in ("statements", "goals")
    )
    require(bool(statements + goals), f"{where}: it has no statements; write [[statements]]")
    texts = {n: " ".join(_take(found, n, str, where, "").split()) for n in _OF_FILE[:4]}
    return ClaimsFile(**texts, words=words, statements=statements, goals=goals)


def _make_statement(found: Plain, shared: Plain, where: str) -> Statement:
    _check_keys(found, _OF_STATEMENT, where)
    texts = {
        name: " ".join(_take(found, name, str, where, "" if name == "decided" else None).split())
        for name in _OF_STATEMENT[:5]
    }
    where = f"{where.rpartition(': ')[0]}: {texts['name']}"
    inherited = _join(shared, found)
    claims = tuple(
        _make_claim(one, inherited, f"{where}, claim {number}")
        for number, one in enumerate(_take_tables(found, "claims", where), 1)
    )
    require(bool(claims), f"{where}: it makes no claims; write [[statements.claims]]")
    return Statement(**texts, claims=claims)


def _make_claim(found: Plain, inherited: Plain, where: str) -> StatedClaim:
    _check_keys(found, ("text", "parts", *FIELDS), where)
    own = _join(inherited, found)
    text = _take(found, "text", str, where)
    parts = []
    for part in _take_tables(found, "parts", where) or [{}]:
        _check_keys(part, FIELDS, where)
        parts.append(_make_part(_join(own, part), where))
    return StatedClaim(text, " ".join(_take(own, "reason", str, where).split()), tuple(parts))


def _make_part(found: Plain, where: str) -> Part:
    kind = _choose(_take(found, "kind", str, where), tuple(KINDS), f"{where}: kind")
    wanted = KINDS[kind]
    against = found.get("against", "")
    if kind == "not_judged":
        return Part(
            kind=kind, select={}, against="", of=(), side="", bound=math.nan, exact=False, label=""
        )
    if wanted is None:
        against = ""
    elif not isinstance(against, wanted) or not against:
        use = "columns with values" if wanted is dict else "the name of a column in `select`"
        raise InputError(f"{where}: against: {kind} needs {use}; write against = ...")
    select = _make_selection(_take(found, "select", dict, where), f"{where}: select")
    other = _make_selection(against, f"{where}: against") if wanted is dict else against
    if wanted is str:
        require(
            against in select,
            f"{where}: against: {against!r} is not in `select`; list its values there",
        )
    beside = other.values() if isinstance(other, dict) else [select.get(other, ("",))]
    count = math.prod(map(len, [*select.values(), *beside]))
    require(
        count <= MOST_COMPARISONS,
        f"{where}: these are {count} comparisons; select at most {MOST_COMPARISONS}",
    )
    of = found.get("of", "identity")
    names = of if isinstance(of, list) else [of]
    side = _choose(_take(found, "side", str, where), ("below", "above"), f"{where}: side")
    return Part(
        kind=kind,
        select=select,
        against=other,
        of=tuple(_choose(name, OF, f"{where}: of") for name in names),
        side=cast(Side, side),
        bound=_make_number(found.get("bound"), f"{where}: bound"),
        exact=_take(found, "exact", bool, where, False),
        label=_take(found, "label", str, where, ""),
    )


def _join(outer: Plain, inner: Plain) -> Plain:
    """Return the fields of claims that hold inside: selections are joined, others replaced."""
    joined = {**outer, **{name: inner[name] for name in FIELDS if name in inner}}
    for name in ("select", "against"):
        one, other = outer.get(name), inner.get(name)
        if isinstance(one, dict) and isinstance(other, dict):
            joined[name] = one | other
    return joined


def _make_selection(found: Plain, where: str) -> dict[str, tuple[Value, ...]]:
    selection = {}
    for column, values in found.items():
        listed = values if isinstance(values, list) else [values]
        kept = [_make_value(value, f"{where}: {column}") for value in listed]
        require(bool(kept), f"{where}: {column}: the list is empty; name a value")
        selection[column] = tuple(dict.fromkeys(kept))
    return selection


def _make_value(value: object, where: str) -> Value:
    if isinstance(value, str | bool):
        return value
    return tidy(_make_number(value, where))


def _make_number(value: object, where: str) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300:
        return float(value)
    raise InputError(f"{where}: {value!r} is no number; give a finite one")


def _check_keys(found: Plain, known: Sequence[str], where: str) -> None:
    for name in found:
        _choose(name, known, where)


def _choose(name: object, known: Sequence[str], where: str) -> str:
    if not isinstance(name, str) or name not in known:
        raise InputError(f"{where}: {name!r} is not known; {suggest_name(str(name), known)}")
    return name


def _take(found: Plain, name: str, kind: type[T], where: str, default: T | None = None) -> T:
    value = found.get(name, default)
    if not isinstance(value, kind):
        need = {str: "a text", bool: "true or false"}.get(kind, "a table")
        raise InputError(f"{where}: {name}: {need} is needed; write {name} = ...")
    return value


def _take_tables(found: Plain, name: str, where: str) -> list[Plain]:
    value = found.get(name, [])
    if isinstance(value, list) and all(isinstance(one, dict) for one in value):
        return value
    raise InputError(f"{where}: {name}: a list of tables is needed")
