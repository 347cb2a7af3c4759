"""Searches the best values of parameters with Optuna: queries values, and tells their score."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.config import Plain
from owtsweep.errors import as_text

if TYPE_CHECKING:
    import optuna

#: Parameter -> [low, high, scale] with the scale "linear", "log" or "int", or a mapping whose key
#: `options` lists the values to choose from.
Space = Mapping[str, Any]

#: Computes the score of some values (parameter -> value). It may raise ArithmeticError or
#: ValueError (so `InputError` and LinAlgError), if there is no score.
Objective = Callable[[Plain], float]


class Searched(NamedTuple):
    """Numbers that are searched together.

    schemes: All schemes that have them: the numbers shall serve all of them.
    space: Key of the configuration -> its bounds and its scale.
    counts: whether any estimate depends on the numbers under a configuration of one tuning.
    """

    schemes: Sequence[str]
    space: Space
    counts: Callable[[Any], bool] = lambda config: True


@dataclass(frozen=True)
class Trial:
    """Values that were tried.

    `score`: the score, less is better; infinite if there is none. `reason`: why the objective could
    not be computed; else empty.
    """

    values: Plain
    score: float
    reason: str = ""


def attempt(objective: Objective, values: Plain) -> Trial:
    """Compute the score of some values; a score that is not finite counts as infinite."""
    try:
        score = objective(values)
    except (ArithmeticError, ValueError) as error:
        return Trial(values, float("inf"), reason=as_text(error))
    return Trial(values, score if np.isfinite(score) else float("inf"))


def search(
    space: Space, objective: Objective, *, trials: int, seed: int, starts: Sequence[Plain] = ()
) -> Iterator[Trial]:
    """Search for the values with the least score; yield each trial as soon as it has been made.

    The same arguments give the same trials. If the objective is interrupted, so is the iteration;
    the trials until then are already with the caller.

    trials, seed: Number of trials, and seed of the sampler.
    starts: Values of the first trials. A value that is missing or out of bounds is sampled.
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed, multivariate=True))
    for start in starts:
        within = {key: start[key] for key in space if _is_within(start.get(key), space[key])}
        study.enqueue_trial(within, skip_if_exists=True)
    for _ in range(trials):
        asked = study.ask()
        values = {key: _suggest(asked, key, bounds) for key, bounds in space.items()}
        trial = attempt(objective, values)
        study.tell(asked, trial.score)
        yield trial


def _is_within(value: Any, bounds: Any) -> bool:
    if isinstance(bounds, Mapping):
        return value in bounds["options"]
    return value is not None and bool(bounds[0] <= value <= bounds[1])


def _suggest(trial: optuna.Trial, key: str, bounds: Any) -> Any:
    if isinstance(bounds, Mapping):
        return trial.suggest_categorical(key, list(bounds["options"]))
    low, high, scale = bounds
    if scale == "int":
        return trial.suggest_int(key, low, high)
    return trial.suggest_float(key, low, high, log=scale == "log")
