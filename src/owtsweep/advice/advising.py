"""Advice for one case, part by part: the answer, its levers, and other worlds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from owtsweep.advice import describe
from owtsweep.advice.answer import Answer, find_answer, measure_closely
from owtsweep.advice.found import Error
from owtsweep.advice.levers import Pulled, pull_levers
from owtsweep.advice.question import Question
from owtsweep.advice.worlds import Turned, join_worlds, try_worlds
from owtsweep.results.regret import tell_regret
from owtsweep.sweep.progress import Progress


@dataclass
class Advice:
    """Which estimator to run in one case, how good it is, and what would change that.

    question: the case.
    answer: who is best, with error, runner-up, baseline and bound.
    closer: the error of the best over more records; None if it was not measured.
    levers: what each change of a sensor brings.
    worlds: what it turns to where the truth is not what schemes are told.
    lines: All of it in words.

    >>> import owtsweep
    >>> advice = owtsweep.advise([
    ...     "natural_period=4", "amplitude=0.5", "record.duration=100", "schemes=[MKF,HME1]",
    ... ], quick=True)
    >>> said = advice.as_plain()
    >>> said["scheme"], round(said["error"], 2), said["unit"]
    ('HME1', 0.05, 'm')
    """

    question: Question
    answer: Answer | None = None
    closer: Error | None = None
    levers: list[Pulled] = field(default_factory=list)
    worlds: list[Turned] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        """Return all lines that have been told."""
        return "\n".join(self.lines)

    def tell(self, progress: Progress | None = None, *, quick: bool = False) -> Iterator[str]:
        """Compute part after part; yield the lines of each as soon as it is there.

        quick: whether the answer is all.
        Raises InputError if the case cannot be run, or no contender has a result.
        """
        for line in self._tell(progress, quick):
            self.lines.append(line)
            yield line

    def _tell(self, progress: Progress | None, quick: bool) -> Iterator[str]:
        yield from describe.tell_question(self.question)
        answer = self.answer = find_answer(self.question, progress)
        yield from describe.tell_answer(answer)
        if quick:
            return
        yield describe.HEADING_OF_LEVERS
        for pulled in pull_levers(self.question, answer):
            self.levers.append(pulled)
            yield describe.tell_pulled(pulled, answer)
        yield describe.tell_most(self.levers)
        yield from self._tell_worlds(answer)
        self.closer = measure_closely(self.question, answer, progress)  # it takes the longest
        if self.closer is not None:
            yield describe.tell_closer(self.closer, answer)

    def _tell_worlds(self, answer: Answer) -> Iterator[str]:
        if not self.question.study.list_worlds(self.question.config):
            return
        yield describe.HEADING_OF_WORLDS
        yield describe.tell_nominal(answer)
        for turned in try_worlds(self.question, answer):
            self.worlds.append(turned)
            yield describe.tell_turned(turned, answer)
        tried = [turned.world for turned in self.worlds if not turned.refused]
        if tried:
            yield from tell_regret(join_worlds(self.question, tried))

    def as_plain(self) -> dict[str, object]:
        """Return the advice as dicts, lists and scalars, e.g. for JSON; NaN is None."""
        assert self.answer is not None, "nothing has been told yet"
        answer, found = self.answer, self.answer.found
        row = found.cells.iloc[0]
        error = self.closer or answer.error
        return {
            "study": self.question.study.name,
            "cell": {condition.name: value for condition, value in self.question.cell.items()},
            "criterion": str(row["criterion"]),
            "unit": found.criterion.unit,
            "scheme": answer.best,
            "verdict": str(row["verdict"]),
            **_list_error(error),
            "runner_up": str(row["runner_up"] or ""),
            "runner_up_error": _clean(row["error_runner_up"]),
            "baseline": str(row.get("baseline", "")),
            "baseline_error": _clean(row.get("error_baseline", np.nan)),
            "bound": answer.bound,
            "simplest": answer.simplest,
            "simplest_error": answer.simplest_error,
            "margin": answer.margin,
            "levers": [
                {
                    "change": pulled.change,
                    "scheme": pulled.best,
                    "error": _clean(pulled.error),
                    "ratio": _list_error(pulled.ratio) if pulled.ratio else None,
                    "refused": pulled.refused,
                }
                for pulled in self.levers
            ],
            "worlds": [_list_turned(turned) for turned in self.worlds],
            "run": str(found.run.folder),
        }


def _list_turned(turned: Turned) -> dict[str, object]:
    values = turned._asdict().items()
    return {name: _clean(v) if isinstance(v, float) else v for name, v in values}


def _list_error(error: Error) -> dict[str, object]:
    return {
        "error": _clean(error.value),
        "error_low": _clean(error.low),
        "error_high": _clean(error.high),
        "n": error.n,
    }


def _clean(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
