"""The answer for one case: who is best, how good that is, and what stands beside it."""

from __future__ import annotations

from typing import NamedTuple

from owtsweep.advice.found import Error, Found, find
from owtsweep.advice.question import Question
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.study import blame


class Answer(NamedTuple):
    """The answer for one case.

    best: the scheme or baseline to run, with its `error`.
    simplest: the simplest contender whose error is within `margin` of that, and its error.
    bound: the least error that is possible in the criterion's unit; None if it is not known.
    """

    found: Found
    best: str
    error: Error
    simplest: str
    simplest_error: float
    margin: float
    bound: float | None


def find_answer(question: Question, progress: Progress | None = None) -> Answer:
    """Find the best contender of a case, and how good it is.

    Raises InputError as `found.find`.
    """
    study, config = question.study, question.config
    found = find(study, config, progress)
    row, ratios = found.cells.iloc[0], found.tables["ratios"]
    best, margin = str(row["best"]), float(config.records.margin) if config.records else 0.0
    near = ratios[(ratios["criterion"] == row["criterion"]) & (ratios["ratio"] <= 1.0 + margin)]
    errors = {
        best: float(row["error_best"]),
        **dict(zip(near["scheme"], near["error"], strict=True)),
    }
    simplest = next(name for name in found.contents.contenders if name in errors)
    with blame(study):
        bound = study.find_bound(config)
    return Answer(
        found,
        best,
        found.measure(best),
        simplest,
        errors[simplest],
        margin,
        None if bound is None else float(found.criterion.express(bound)),
    )


def measure_closely(
    question: Question, given: Answer, progress: Progress | None = None
) -> Error | None:
    """Return the error of the best contender over more records; None if it has as many already.

    These are `Study.advised_records`: so many that the error is that of the long run.
    """
    records, contents = question.study.advised_records, given.found.contents
    if given.error.n >= records:
        return None
    baseline = given.best in contents.baselines
    first = next(name for name in contents.contenders if name not in contents.baselines)
    words = [
        f"schemes=[{first if baseline else given.best}]",
        f"baselines=[{given.best if baseline else ''}]",
        f"grid.replicates={records}",
    ]
    return find(question.study, question.change(*words), progress).measure(given.best)
