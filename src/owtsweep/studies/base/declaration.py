"""A study as data: its axes, its schemes, and functions that lead from truth to score."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Generic, Literal, NamedTuple, TypeVar

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Reading
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.base.contest import Contest, ContestConfig
from owtsweep.studies.base.contract import Part
from owtsweep.studies.base.schemes import SchemeTable

Config = TypeVar("Config", bound=ContestConfig)
Truth = TypeVar("Truth")
Record = TypeVar("Record")
Known = TypeVar("Known")
Measured = TypeVar("Measured")
Estimates = TypeVar("Estimates")


class Quantity(NamedTuple):
    """A field of a study's estimates.

    Attributes
    ----------
    shape
        The shape of the value at one sample, e.g. (3,), whose sizes may be -1: any.
    optional
        Whether the field may be None.
    """

    shape: tuple[int, ...]
    optional: bool = False


class Shown(NamedTuple):
    """What `owtsweep.estimate` shows of a record; the fields are those of `EstimatedRecord`."""

    time: Array
    truth: Mapping[str, Array]
    measurements: Mapping[str, Reading]
    units: Mapping[str, str]
    at_rest: Mapping[str, Array] = MappingProxyType({})


class Stated(NamedTuple):
    """What `owtsweep.estimate` shows of a scheme: quantities, covariances, wait."""

    estimates: Mapping[str, Array]
    covariances: Mapping[str, Array]
    wait: float


@dataclass(frozen=True, kw_only=True)
class Declaration(Generic[Config, Truth, Record, Known, Measured, Estimates]):
    """What is a study's own.

    Attributes
    ----------
    contest
        The axes, the criteria, and words for truth and sensors.
    schemes
        The study's schemes.
    list_content
        What the rows of every block depend on, as plain data: of a configuration.
    most_records
        Most records of a block: of a configuration.
    shared
        What the blocks of a group share: the truth alone, where that is dear; else measurements.
    make_truth
        The motion of a record: of a configuration, a cell, and the record's number.
    measure
        The record with what its sensors say: of a configuration, a cell, and the truth.
    inform
        The parts of a record with what schemes are told of each: of the configuration of one
        tuning, a cell, and a record. The cell lacks the axes that a scheme ignores.
    score
        Measure -> value: of the configuration of one tuning, a cell, a record, its parts, and the
        estimates of each.
    estimates
        The fields of a scheme's estimates. Arrays begin with the record's samples.
    count_samples
        Number of samples of a record.
    show
        What `owtsweep.estimate` shows: of a configuration and a record.
    state
        What it shows of a scheme: of a record, and the estimates of its parts.
    warn
        Function that warns of what a configuration makes doubtful, once before the first block.
    require
        Function that refuses, before anything is planned, a configuration that no scheme can serve.
    """

    contest: Contest[Config]
    schemes: SchemeTable
    list_content: Callable[[Config], dict[str, object]]
    most_records: Callable[[Config], int]
    shared: Literal["truth", "measurements"] = "measurements"
    make_truth: Callable[[Config, Cell, int], Truth]
    measure: Callable[[Config, Cell, Truth], Record]
    inform: Callable[[Config, Cell, Record], Mapping[str, Part[Known, Measured]]]
    score: Callable[
        [Config, Cell, Record, Mapping[str, Part[Known, Measured]], Mapping[str, Estimates]],
        dict[str, float],
    ]
    estimates: Mapping[str, Quantity]
    count_samples: Callable[[Record], int]
    show: Callable[[Config, Record], Shown]
    state: Callable[[Record, Mapping[str, Estimates]], Stated]
    warn: Callable[[Config], object] = lambda config: None
    require: Callable[[Config], object] = lambda config: None


#: A declaration of any study, a part of its records, and a scheme of it. Truth, records, knowledge
#: and estimates pass from one function of a declaration to the next; nobody here looks inside.
AnyDeclaration = Declaration[Any, Any, Any, Any, Any, Any]
AnyPart = Part[Any, Any]
