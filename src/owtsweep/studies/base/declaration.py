"""A study as data: its axes, its schemes, and functions that lead from truth to score."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Generic, Literal, NamedTuple, TypeVar

from owtsweep.arrays import Array
from owtsweep.config import Config as Keys
from owtsweep.evaluation.estimate import Reading
from owtsweep.results.status import OK
from owtsweep.studies.base.axes import Axes, Cell, Untold
from owtsweep.studies.base.schemes import Part, SchemeTable

Config = TypeVar("Config", bound=Keys)
Truth = TypeVar("Truth")
Record = TypeVar("Record")
Known = TypeVar("Known")
Measured = TypeVar("Measured")
Estimates = TypeVar("Estimates")


#: A scheme of the study at hand.
TheScheme = Any


class Means(NamedTuple):
    """Mean squares over a record, as products of the errors from motion and from noise.

    measures, windows: Names, n entries each.
    products: Means of motion x motion, motion x noise, noise x noise, shape (n, 3). The last is the
        mean square itself if motion and noise were run as one series.
    n_samples: Number of samples in each mean, n numbers.
    """

    measures: Sequence[str]
    windows: Sequence[str]
    products: Array
    n_samples: Sequence[int]


F = TypeVar("F")


class Judgement(NamedTuple, Generic[F]):
    """What a scheme's estimates of a record are worth, or why there are none.

    `found` has measure -> value, or `Means`; `status` and `reason` are as in rows
    (`owtsweep.results.status`).
    """

    found: F | None
    status: str = OK
    reason: str = ""


class Quantity(NamedTuple):
    """A field of a study's estimates, which may be None if `optional`.

    `shape` is that of the value at one sample, e.g. (3,), whose sizes may be -1: any.
    """

    shape: tuple[int, ...]
    optional: bool = False


class Shown(NamedTuple):
    """What `owtsweep.estimate` shows of a record; the fields are those of `EstimatedRecord`."""

    time: Array
    settled: int
    truth: Mapping[str, Array]
    measurements: Mapping[str, Reading]
    units: Mapping[str, str]
    at_rest: Mapping[str, Array] = MappingProxyType({})


class Stated(NamedTuple):
    """What `owtsweep.estimate` shows of a scheme: quantities, covariances, latency."""

    estimates: Mapping[str, Array]
    covariances: Mapping[str, Array]
    wait: float


class Batch(NamedTuple):
    """How a study runs many schemes on many records at once, by compiled kernels.

    serves: whether a scheme runs so: of the configuration of one tuning, and the scheme.
    make_records: Some records as one object: of a configuration, a cell, and the records' numbers.
    run: Run schemes side by side on such records: of the configuration of one tuning, a cell, the
        records and the schemes. The result has an entry for each scheme, what its estimates of each
        record are worth, or the exception that it raised. The numbers are those of `prepare`, `run`
        and `score`.
    """

    serves: Callable[[Any, TheScheme], bool]
    make_records: Callable[[Any, Cell, Sequence[int]], Any]
    run: Callable[[Any, Cell, Any, Sequence[TheScheme]], list[list[Judgement[Means]] | Exception]]


@dataclass(frozen=True, kw_only=True)
class Declaration(Generic[Config, Truth, Record, Known, Measured, Estimates]):
    """What is a study's own.

    list_content: What the rows of every block depend on, as plain data: of a configuration.
    most_records: Most records of a block: of a configuration.
    shared: What the blocks of a group share, by where its axes enter: the world alone, where the
        truth is dear; else measurements, too.
    make_truth: the motion of a record: of a configuration, a cell, and the record's number.
    measure: the record with what its sensors say: of a configuration, a cell, and the truth.
    inform: the parts of a record with the knowledge of each: of the configuration of one tuning, a
        cell, and a record. The cell lacks the axes that a scheme ignores.
    tell: the knowledge that a scheme gets: of the scheme, and what `inform` says.
    score: Measure -> value, or `Means`: of the configuration of one tuning, a cell, a record, its
        parts, and the estimates of each.
    estimates: the fields of a scheme's estimates. Arrays begin with the record's samples.
    count_samples: Number of samples of a record.
    show: What `owtsweep.estimate` shows: of a configuration, a cell and a record.
    state: What it shows of a scheme: of a record, and the estimates of its parts.
    warn: Warns of what a configuration makes doubtful, once before the first block.
    require: Refuses, before anything is planned, a configuration that no scheme can serve.
    superposes: whether one run of a scheme serves all values of the axis that scales the motion: of
        the configuration of one tuning, and the scheme. Such a run has a cell without this axis.
        None: rows have values, no products.
    batch: How schemes run by compiled kernels; None: they do not.
    list_untold: What of truth and measurements schemes are not told, for the key `over`: of a
        configuration.

    In a world that departs from what schemes are told, `make_truth`, `measure` and the records of
    `batch` have the configuration and the cell of the truth; all else has those of the knowledge.
    """

    axes: Axes[Config]
    schemes: SchemeTable
    list_content: Callable[[Config], dict[str, object]]
    most_records: Callable[[Config], int]
    shared: Sequence[Literal["world", "sensors"]] = ("world", "sensors")
    make_truth: Callable[[Config, Cell, int], Truth]
    measure: Callable[[Config, Cell, Truth], Record]
    inform: Callable[[Config, Cell, Record], Mapping[str, Part[Known, Measured]]]
    tell: Callable[[TheScheme, Known], Known] = lambda scheme, known: known
    score: Callable[
        [Config, Cell, Record, Mapping[str, Part[Known, Measured]], Mapping[str, Estimates]],
        Mapping[str, float] | Means,
    ]
    estimates: Mapping[str, Quantity]
    count_samples: Callable[[Record], int]
    show: Callable[[Config, Cell, Record], Shown]
    state: Callable[[Record, Mapping[str, Estimates]], Stated]
    warn: Callable[[Config], object] = lambda config: None
    require: Callable[[Config], object] = lambda config: None
    superposes: Callable[[Config, TheScheme], bool] | None = None
    batch: Batch | None = None
    list_untold: Callable[[Config], Untold] = lambda config: Untold()


#: A declaration of any study, a part of its records, and a scheme of it. Truth, records, knowledge
#: and estimates pass from one function of a declaration to the next; nobody here looks inside.
AnyDeclaration = Declaration[Any, Any, Any, Any, Any, Any]
AnyPart = Part[Any, Any]
