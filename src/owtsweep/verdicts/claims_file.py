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
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic import model_validator as validator

from owtsweep.config import Plain
from owtsweep.config.hints import suggest_name
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text
from owtsweep.verdicts.inference import Side
from owtsweep.verdicts.score_table import Value, tidy

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


def _list(value: object) -> list[object]:
    return value if isinstance(value, list) else [value]


def _number(value: object) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300:
        return float(value)
    raise ValueError(f"{value!r} is no number; give a finite one")


def _values(given: object) -> tuple[Value, ...]:
    values = _list(given)
    if not values:
        raise ValueError("the list is empty; name a value")
    each = (value if isinstance(value, str | bool) else tidy(_number(value)) for value in values)
    return tuple(dict.fromkeys(each))


def _known(name: object, known: tuple[str, ...]) -> str:
    if name not in known:
        raise ValueError(f"{name!r} is not known; {suggest_name(str(name), known)}")
    return str(name)


Text = Annotated[str, AfterValidator(lambda text: " ".join(text.split()))]
Number = Annotated[float, BeforeValidator(_number)]
Columns = dict[str, Annotated[tuple[Any, ...], BeforeValidator(_values)]]


class _Held(BaseModel):
    """A table of the file. What it says of its claims is handed down to what it holds."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    holds: ClassVar[tuple[str, ...]] = ()

    @validator(mode="before")
    @classmethod
    def _hand_down(cls, given: object) -> object:
        if not isinstance(given, dict) or not cls.holds:
            return given
        shared = {name: given[name] for name in FIELDS if name in given}
        found = {k: v for k, v in given.items() if k not in shared or k in cls.model_fields}
        for name in cls.holds:
            held = found.get(name)
            if isinstance(held, list):
                found[name] = [_join(shared, one) if isinstance(one, dict) else one for one in held]
        return found


class Part(_Held):
    """Comparisons of one kind; the module tells the meaning of each attribute."""

    kind: Annotated[str, BeforeValidator(lambda kind: _known(kind, tuple(KINDS)))]
    select: Columns = Field(default={})
    against: Columns | str = ""
    of: Annotated[
        tuple[str, ...],
        BeforeValidator(lambda names: tuple(_known(name, OF) for name in _list(names))),
    ] = ("identity",)
    side: Side = ""
    bound: Number = math.nan
    reason: Text = ""
    exact: bool = False
    label: str = ""

    @validator(mode="before")
    @classmethod
    def _leave_out(cls, given: object) -> object:
        """Leave out what other parts of the claim compare with."""
        if isinstance(given, dict) and KINDS.get(str(given.get("kind")), dict) is None:
            return {name: value for name, value in given.items() if name != "against"}
        return given

    @validator(mode="after")
    def _check(self) -> Part:
        if self.kind == "not_judged":
            return self
        wanted, against = KINDS[self.kind], self.against
        if wanted is not None and not (isinstance(against, wanted) and against):
            use = "columns with values" if wanted is dict else "the name of a column in `select`"
            raise ValueError(f"against: {self.kind} needs {use}; write against = ...")
        if wanted is str and against not in self.select:
            raise ValueError(f"against: {against!r} is not in `select`; list its values there")
        if not self.side or math.isnan(self.bound) or not self.select:
            raise ValueError(f"{self.kind} needs `select`, `side` and `bound`")
        beside = against.values() if isinstance(against, dict) else [self.select.get(against, "-")]
        count = math.prod(map(len, [*self.select.values(), *beside]))
        if count > MOST_COMPARISONS:
            raise ValueError(f"these are {count} comparisons; select at most {MOST_COMPARISONS}")
        return self

    @property
    def columns(self) -> set[str]:
        """The names of all columns that are compared."""
        beside = {self.against} if isinstance(self.against, str) else set(self.against)
        return set(self.select) | (beside - {""})


class StatedClaim(_Held):
    """A claim of a statement, and the reason of its bounds."""

    holds = ("parts",)
    text: str
    reason: Text
    parts: Annotated[tuple[Part, ...], Field(strict=False)]

    @validator(mode="before")
    @classmethod
    def _begin(cls, given: object) -> object:
        """Make a part of a claim without parts. This runs before fields are handed down."""
        return {"parts": [{}], **given} if isinstance(given, dict) else given


class Statement(_Held):
    """A statement of a paper, or a goal.

    name, text: E.g. "F1", and what the paper says.
    printed: where it is printed.
    definition: the test in words.
    decided: What was decided after data had been seen; "" if nothing was.
    """

    holds = ("claims",)
    name: Text
    text: Text
    printed: Text
    definition: Text
    decided: Text = ""
    claims: Annotated[tuple[StatedClaim, ...], Field(strict=False, min_length=1)]


class ClaimsFile(_Held):
    """The content of a file of claims.

    `study`, `paper`, `script`, `note`: name of the study, name of the paper, module that makes
    scores which the rows of a run are not, and a sentence on the origin of the tests; "" where the
    file says nothing. `words`: value of a column -> how labels tell it. `statements`, `goals`: what
    the paper says, and what the project wants to reach.
    """

    holds = ("statements", "goals")
    study: Text = ""
    paper: Text = ""
    script: Text = ""
    note: Text = ""
    words: dict[str, str] = Field(default={})
    statements: Annotated[tuple[Statement, ...], Field(strict=False)] = ()
    goals: Annotated[tuple[Statement, ...], Field(strict=False)] = ()


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
    try:
        file = ClaimsFile.model_validate(found)
    except ValidationError as error:
        raise InputError(f"{path}: {_tell(error)}") from None
    require(
        bool(file.statements + file.goals), f"{path}: it has no statements; write [[statements]]"
    )
    return file


def _join(outer: Plain, inner: Plain) -> Plain:
    """Return a table with the fields of claims from outside: selections are joined."""
    joined = {**outer, **inner}
    for name in ("select", "against"):
        one, other = outer.get(name), inner.get(name)
        if isinstance(one, dict) and isinstance(other, dict):
            joined[name] = one | other
    return joined


def _tell(error: ValidationError) -> str:
    """Say in one line what is wrong first, with the number of its statement, claim and part."""
    faults = error.errors(include_url=False)
    first = min(faults, key=lambda fault: fault["type"] != "extra_forbidden")
    steps: list[str] = []
    for part in first["loc"]:
        if isinstance(part, int):
            steps[-1] = f"{steps[-1].removesuffix('s')} {part + 1}"  # e.g. statement 1
        else:
            steps.append(str(part))
    *above, name = steps
    where = f"{', '.join(above)}: " if above else ""
    if first["type"] == "extra_forbidden":
        known = (*FIELDS, *ClaimsFile.model_fields, *Statement.model_fields, "parts")
        return f"{where}{name!r} is not known; {suggest_name(name, known)}"
    if first["type"] == "missing":
        return f"{where}{name} is missing; write {name} = ..."
    told = first["msg"].removeprefix("Value error, ").replace("Input should be", "it must be")
    return f"{where}{name}: {told.replace('tuple', 'list').replace('dictionary', 'table')}"
