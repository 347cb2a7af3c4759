"""The keys of the section `grid` that say how many records a cell of the map gets."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator

from owtsweep.config.section import Positive, Section, key
from owtsweep.statistics.deciding import FIRST, LOOKS, MARGIN, MOST

#: Most records of a cell in a fixed design.
MOST_RECORDS = 1_000_000
_FIRST_LOOKS = f"{', '.join(map(str, LOOKS[:7]))}, ..."


def _read_count(value: object) -> object:
    if value == "auto":
        return value
    whole = int(value) if isinstance(value, float) and value.is_integer() else value
    try:
        count = int(str(whole))
    except ValueError:
        raise ValueError(f"{value!r} is neither a whole number nor auto") from None
    if count < 1:
        raise ValueError(f"{value} must be at least 1")
    if count > MOST_RECORDS:
        raise ValueError(f"{value} is more than {MOST_RECORDS}; lower it")
    return count


def _require_look(most: int) -> int:
    if most not in LOOKS:
        raise ValueError(
            f"{most} is not the number of records of a look; use one of {_FIRST_LOOKS}"
        )
    return most


class Records(Section):
    """The keys of the section `grid` of every study, besides those of its axes."""

    replicates: Annotated[int | Literal["auto"], BeforeValidator(_read_count)] = key(
        "records per cell, each with random numbers of its own; auto: until the cell is decided"
    )
    margin: Positive = key(
        "with auto: the difference of two errors that does not matter, as a part of the error",
        default=MARGIN,
        le=1,
    )
    most: Annotated[int, AfterValidator(_require_look)] = key(
        f"with auto: most records per cell, one of {_FIRST_LOOKS}", default=MOST
    )
    budget: Positive | None = key(
        "with auto: after this time no further look begins; the same command goes on", unit="s",
        default=None,
    )  # fmt: skip

    @property
    def decides(self) -> bool:
        """Whether cells get records until they are decided."""
        return self.replicates == "auto"

    @property
    def first(self) -> int:
        """Number of records that every cell gets."""
        return FIRST if self.replicates == "auto" else self.replicates

    @property
    def greatest(self) -> int:
        """Most records that a cell may get."""
        return self.most if self.replicates == "auto" else self.replicates

    def count_records(self) -> str:
        """Return in words how many records a cell has, e.g. "20" or "8 to 256"."""
        return " to ".join(dict.fromkeys((str(self.first), str(self.greatest))))

    def describe_records(self) -> str:
        """Return in words that a cell has so many records."""
        until = ", until it is decided" * (self.greatest > self.first)
        return f"{self.count_records()} record{'s' * (self.replicates != 1)} per cell{until}"


#: Keys of `grid` that say how a contest goes on, not what it is over.
CONTEST_KEYS = frozenset(Records.model_fields) - {"replicates"}
