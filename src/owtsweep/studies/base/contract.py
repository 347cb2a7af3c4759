"""What a scheme of a study is, and what the house gives to it and takes from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

Known = TypeVar("Known", contravariant=True)
Measured = TypeVar("Measured", contravariant=True)
Estimates = TypeVar("Estimates", covariant=True)
K = TypeVar("K")
M = TypeVar("M")


class Unable(Exception):
    """A scheme cannot work at a setting; the message is the reason."""


class NotFinite(Exception):
    """A scheme's estimates are not finite, or not of the declared shape; the message says where."""


class Ready(Protocol[Measured, Estimates]):
    """A scheme made ready for what it knows: gains are computed, records can be run."""

    def run(self, measured: Measured, /) -> Estimates:
        """Estimate from the measurements of a record."""


class Scheme(Protocol[Known, Measured, Estimates]):
    """An estimation scheme of a study.

    A user's may also have the attribute `ignores`: names of axes of what schemes are told on which
    its estimates do not depend. Then one record serves all values of these axes.
    """

    name: str

    def prepare(self, known: Known, /) -> Ready[Measured, Estimates]:
        """Make the scheme ready for what it is told.

        Raises
        ------
        Unable
            If the scheme cannot work there; the message says why.
        """


@dataclass(frozen=True)
class Part(Generic[K, M]):
    """One part of a record, e.g. one direction of motion.

    Attributes
    ----------
    known
        What schemes are told beforehand.
    measured
        What sensors say.
    """

    known: K
    measured: M
