"""Schemes that break the contract in every way: as they are made, read and run."""

import abc
import asyncio
import sys

import numpy as np

from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.evaluation.loop import RecordEstimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.schemes import hub

ERRORS = {
    "exit": SystemExit(3), "closed": GeneratorExit(), "cancelled": asyncio.CancelledError(),
    "recursion": RecursionError("deep"), "memory": MemoryError(), "odd": BaseException("a\x1bb"),
}  # fmt: skip


class Good(hub.Scheme):
    """Keeps the contract; the others break one part of it."""

    name = "Good"
    linear = True

    def start(self, known):
        return Still()


class Still:
    def update(self, specific_force, position=None):
        return Estimate(np.zeros(2), np.zeros(2))


class Made(Good):
    """Its constructor raises."""

    def __init__(self, how):
        raise ERRORS[how]


def raising(self):
    raise SystemExit(3)


class Name(Good):
    name = property(raising)


class Linear(Good):
    linear = property(raising)


class Under(Good):
    def under(self, tuning):
        sys.exit(3)


class UnderNothing(Good):
    def under(self, tuning):
        return None


class Sections(Good):
    sections = property(raising)


class NoSections(Good):
    sections = ("nowhere", "mkf")


class TextSections(Good):
    sections = "mkf"


class OddSections(Good):
    sections = (3,)


class Batched(Good):
    batched = property(raising)


class Version(Good):
    class version:
        __str__ = raising

    version = version()


class NumberName(Good):
    name = 3


class NoStart(hub.Scheme):
    name = "NoStart"


class Abstract(Good, abc.ABC):
    @abc.abstractmethod
    def missing(self): ...


class Meta(abc.ABCMeta):
    def __call__(cls, *args):
        sys.exit(3)


class WithMeta(Good, metaclass=Meta):
    pass


class Running(Good):
    """Works until it runs."""

    name = "Running"

    def __init__(self, where, how=""):
        self.where, self.how = where, how

    def start(self, known):
        if self.where == "start":
            raise ERRORS[self.how]
        if self.where == "recorded":
            return Recorded(self.how)
        return Faulty(self.where, self.how)


class LazyEstimate(Estimate):
    covariance = property(raising)

    def __init__(self):
        self.quantities = {"position": np.zeros(2), "velocity": np.zeros(2)}


GARBAGE = {
    "complex": lambda: Estimate(np.zeros(2, dtype=complex), np.zeros(2)),
    "objects": lambda: Estimate(np.array([object(), object()]), np.zeros(2)),
    "texts": lambda: Estimate(np.array(["1", "2"]), np.zeros(2)),
    "ragged": lambda: Estimate([[1, 2], 3], np.zeros(2)),
    "number": lambda: Estimate(0.0, np.zeros(2)),
    "nan": lambda: Estimate(np.full(2, np.nan), np.zeros(2)),
    "huge": lambda: Estimate(np.full(2, 1e200), np.zeros(2)),
    "generator": lambda: (i for i in range(3)),
    "none": lambda: None,
    "covariance": lambda: Estimate(np.zeros(2), np.zeros(2), np.ones(4)),
    "innovation": lambda: Estimate(
        np.zeros(2), np.zeros(2), None, Innovation(np.zeros(2), np.ones(2))
    ),
    "lazy": LazyEstimate,
}


class Faulty:
    def __init__(self, where, how):
        self.where, self.how = where, how

    def update(self, specific_force, position=None):
        if self.where == "update":
            raise ERRORS[self.how]
        return GARBAGE[self.how]()


class Recorded(Still, RecordEstimator):
    """Its whole record at once is not what it should be."""

    def __init__(self, how):
        self.how = how

    def run_record(self, inputs, fixes):
        if self.how == "row":
            return Trajectory(np.zeros((1, 4)))
        if self.how == "texts":
            return Trajectory(np.full((len(inputs), 4), "x"))
        return np.zeros((len(inputs), 4))


class Kernels(Running):
    """Its kernel fails, or is none."""

    name, batched = "Kernels", "chain"

    def kernel(self, known, steps=0):
        if self.where == "kernel":
            raise ERRORS[self.how]
        if self.how == "none":
            return None
        from dataclasses import replace

        from owtsweep.studies.hub.schemes.mkf import SCHEME

        return replace(SCHEME.kernel(known, steps), filter=None)
