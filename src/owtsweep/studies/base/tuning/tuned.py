"""Tunes the schemes of a run, and tells what was found: as a tuning file, and as a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep._version import __version__
from owtsweep.arrays import Array
from owtsweep.config import Plain, as_mapping, with_values
from owtsweep.errors import require
from owtsweep.io.terminal import start_table
from owtsweep.results.criteria import Criterion
from owtsweep.statistics.contrasts import gap
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.base.contest import AnyContest
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.base.searching import Searched, attempt, search
from owtsweep.studies.base.tuning.training import Training, choose_cells

if TYPE_CHECKING:
    from rich.console import RenderableType


def list_searched(every: Sequence[Searched], config: Any) -> list[Searched]:
    """Return what can be searched for the schemes of a run, with those schemes alone.

    Raise `InputError` if there is nothing, or the search would see the records that judge it.
    """
    names = list_names(config.schemes)
    found = [
        part._replace(schemes=[name for name in names if name in part.schemes])
        for part in every
        if part.counts(config)
    ]
    found = [part for part in found if part.schemes]
    known = ", ".join(dict.fromkeys(name for part in every for name in part.schemes))
    require(
        bool(found),
        f"schemes: with tuning={config.tuning_name} these have no numbers to search; `tune` knows "
        f"numbers of {known}",
    )
    require_other_seed(config)
    return found


def require_other_seed(config: Any) -> None:
    """Raise `InputError` if a search would see the records that judge it."""
    require(
        config.tune.seed != config.seed,
        f"tune.seed: {config.seed} is also the run's seed, so a tuning would be judged by what it "
        "was made from; use another",
    )


def dump_tuning(name: str, config: Any, comments: Sequence[str]) -> str:
    """Return the text of the tuning file `name` with the tuned sections of a configuration."""
    import yaml

    sections = {section: as_mapping(getattr(config, section)) for section in config.tuned}
    plain = yaml.safe_dump({"tuning": name, **sections}, sort_keys=False)
    return "\n".join(f"# {line}" for line in comments) + f"\n{plain}"


def predict(
    contest: AnyContest, every: Sequence[Searched], config: Any
) -> tuple[float, float] | None:
    """Return how long search and judgement take, s, and their memory, bytes; None: unknown.

    One core runs all trials. Knowledge of a record is made anew for each trial, and counted as a
    part of the schemes' time.
    """
    costs, parts = contest.costs, list_searched(every, config)
    if costs is None or not all(n in costs.schemes for part in parts for n in part.schemes):
        return None
    settings, cells = config.tune, len(choose_cells(contest, config))
    records = settings.training + settings.replicates
    runs = costs.record * records
    for part in parts:
        each = sum(costs.schemes[name] for name in part.schemes)
        # the tuning to begin with, once more as the first trial, and both tunings at the end
        runs += each * ((settings.trials + 2) * settings.training + 2 * settings.replicates)
    return config.record.steps * cells * runs, costs.memory


def tune(
    declaration: AnyDeclaration,
    contest: AnyContest,
    every: Sequence[Searched],
    config: Any,
    advance: Callable[[str], None],
) -> TunedStudy:
    """Search the best numbers; call `advance` with the schemes' names after each trial.

    If the user stops the search, the best numbers so far are returned.
    """
    parts: list[Searched] = []
    cells, criterion = choose_cells(contest, config), contest.criteria[config.criterion]
    made, stopped, after = 0, False, config
    try:
        training = Training(declaration, config, cells, config.tune.seed, config.tune.training)
        for whole in list_searched(every, config):
            begun = after
            part = whole._replace(schemes=_find_able(training, begun, whole.schemes))
            if not part.schemes:
                continue
            parts.append(part)
            judge = partial(_judge, training, criterion, part.schemes, begun)
            least = attempt(judge, {}).score
            start = {key: attrgetter(key)(begun) for key in part.space}
            trials = search(
                part.space, judge, trials=config.tune.trials, seed=config.tune.seed, starts=[start]
            )
            for trial in trials:
                made += 1
                if trial.score < least:
                    least, after = trial.score, with_values(begun, trial.values)
                advance(", ".join(part.schemes))
    except KeyboardInterrupt:
        stopped = True
    return TunedStudy(declaration, contest, parts, config, after, made, stopped)


def _find_able(training: Training, config: Any, schemes: Sequence[str]) -> list[str]:
    """Return the schemes that have an estimate of every record."""
    return [
        name for name in schemes if np.isfinite(training.run(config, name, config.criterion)).all()
    ]


def _judge(
    training: Training, criterion: Criterion, schemes: Sequence[str], begun: Any, values: Plain
) -> float:
    """Return the score of values, which replace those of the configuration `begun`."""
    tuned = with_values(begun, values)
    errors = [criterion.judge(training.run(tuned, name, tuned.criterion)) for name in schemes]
    return _score(np.array(errors))


def _score(judged: Array) -> float:
    """Return the mean logarithm of the errors, over schemes and cells.

    judged: what is judged of each record, shape (schemes, cells, records).
    """
    return float(np.log(judged.mean(axis=-1)).mean())


@dataclass(frozen=True)
class TunedStudy:
    """The best numbers found, an `owtsweep.sweep.study.Tuned`.

    parts: What was searched. A scheme without estimates in some cell has no part in it.
    before, after: the configurations with the tuning that the search began with, and the best one.
    trials: number of trials made, of all parts together.
    stopped: whether the user stopped the search.
    """

    declaration: AnyDeclaration
    contest: AnyContest
    parts: Sequence[Searched]
    before: Any
    after: Any
    trials: int
    stopped: bool

    def text(self, name: str) -> str:
        return dump_tuning(name, self.after, self._describe())

    def _describe(self) -> list[str]:
        config, tune = self.before, self.before.tune
        searched = "; ".join(
            f"{', '.join(part.space)} for {', '.join(part.schemes)}" for part in self.parts
        )
        return [
            f"Made by `owtsweep tune`, version {__version__}, from {config.tuning_name}.",
            f"Truth: {self.contest.describe_truth(config)}.",
            f"Sensors: {self.contest.describe_sensors(config)}.",
            f"Searched: {searched}.",
            f"{tune.trials} trials of each, {_count_cells(choose_cells(self.contest, config))}, "
            f"{tune.training} records each, seed {tune.seed}"
            + (f"; stopped after {self.trials} trials." if self.stopped else "."),
        ]

    def judge(self) -> RenderableType:
        from rich.console import Group
        from rich.text import Text

        config = self.before
        criterion = self.contest.criteria[config.criterion]
        cells = choose_cells(self.contest, config)
        others = Training(self.declaration, config, cells, config.seed, config.tune.replicates)
        table = start_table(
            f"{criterion.title}\n{_count_cells(cells)}, {config.tune.replicates} records each, "
            f"seed {config.seed}"
        )
        for column in ("scheme", config.tuning_name, "tuned", "change", "95 %"):
            table.add_column(column, justify="left" if column == "scheme" else "right")
        for name in dict.fromkeys(name for part in self.parts for name in part.schemes):
            errors = [
                criterion.judge(others.run(each, name, config.criterion))
                for each in (config, self.after)
            ]
            power = 0.5 if criterion.squared else 1.0
            table.add_row(Text(name), *compare(errors[0], errors[1], power).tell())
        found = "; ".join(
            f"{key} {attrgetter(key)(config):.4g} to {attrgetter(key)(self.after):.4g}"
            for part in self.parts
            for key in part.space
        )
        text = "Errors are geometric means over the cells. Numbers, before and tuned: "
        return Group(table, Text(f"{text}{found}."))


def _count_cells(cells: Sequence[Cell]) -> str:
    return f"{len(cells)} cell{'s' * (len(cells) != 1)}"


class Gain(NamedTuple):
    """The change of a scheme's error from one tuning to another, on the same records.

    before, after: geometric means of the error over the cells, in its unit.
    change, low, high: geometric mean of after / before over records and cells, minus 1, and its
        95 % interval, from the differences between the two, record by record.
    """

    before: float
    after: float
    change: float
    low: float
    high: float

    def tell(self) -> list[str]:
        """Return both errors, their change and its interval, in words."""
        change, low, high = (100.0 * value for value in self[2:])
        reach = f"{low:+z.1f} to {high:+z.1f} %"
        return [f"{self.before:.3g}", f"{self.after:.3g}", f"{change:+z.1f} %", reach]


def compare(before: Array, after: Array, power: float = 1.0) -> Gain:
    """Compare a scheme's errors; `power` of what is judged gives an error, 0.5 of mean squares.

    before, after: what is judged of each record, shape (cells, records).
    """
    errors = [float(np.exp(power * _score(each[None]))) for each in (before, after)]
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = gap(power * np.log(after / before).mean(axis=0))
    return Gain(*errors, *(float(np.expm1(value)) for value in logs[:3]))
