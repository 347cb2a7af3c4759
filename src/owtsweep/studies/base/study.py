"""The class of declared studies; it imports nothing dear, so that `list` and `--help` are quick."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

from owtsweep.config import Plain, checked
from owtsweep.results.conditions import Condition, Value
from owtsweep.studies.base.axes import check_axes
from owtsweep.studies.base.contest import AnyContest, describe_origin
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.studies.base.schemes import SchemeTable
from owtsweep.sweep.study import Engine, Study, Tuned, Varied

if TYPE_CHECKING:
    from owtsweep.comparing.comparison import Aspects, Candidate
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.studies.base.declaration import AnyDeclaration


class ContestStudy(Study):
    """A study whose package has a module `contest`.

    A subclass has `name` and `numerics_version`. Its package has the configuration's class as
    `CONFIG` in its module `config`, `CONTEST` in its module `contest`, and the functions `check`
    and `check_outside` of a configuration in its module `checks`, for what is its own.
    """

    commands = frozenset({"compare", "vary"})
    #: Most samples of a record: of more, what is kept of it does not fit into memory.
    most_samples = 1_000_000

    def config_type(self) -> type[ContestConfig]:
        """Return the class of the study's configurations."""
        return self._find("config", "CONFIG")  # type: ignore[no-any-return]

    def conditions(self, config: ContestConfig) -> tuple[Condition, ...]:
        """Return the two axes of the map."""
        return self.contest().find_conditions(config)

    def scheme_table(self) -> SchemeTable:
        """Return the schemes of the study."""
        return self._find("schemes", "SCHEMES")  # type: ignore[no-any-return]

    def schemes(self) -> dict[str, str]:
        """Return name -> description of each scheme."""
        return self.scheme_table().describe()

    def describe_scheme(self, name: str) -> dict[str, str]:
        """Return facts on a scheme in words, as `Study.describe_scheme` says."""
        return self.scheme_table().describe_one(name)

    def list_simplicity(self) -> dict[str, int]:
        """Return name -> simplicity of each scheme, as `Study.list_simplicity` says."""
        return self.scheme_table().list_simplicity()

    def contest(self) -> AnyContest:
        return self._find("contest", "CONTEST")  # type: ignore[no-any-return]

    def check(self, config: ContestConfig) -> None:
        """Check that the values can work together, as seen before a record is made.

        Raise `InputError` if two values cannot work together; the message says what would work.
        """
        config.record.check_samples(self.most_samples)
        check_axes(self.contest(), config)
        self._find("checks", "check")(config)

    def check_outside(self, config: ContestConfig) -> None:
        """Raise `InputError` if a file or another study's configuration cannot be used."""
        self._find("checks", "check_outside")(config)

    def describe_origin(self, config: ContestConfig) -> str:
        """Return in a line the tuning, the truth, the sensors, the records and their seed."""
        return describe_origin(self.contest(), config)

    def describe_run(self, run: Candidate) -> Aspects:
        """Describe a run by its axes, as `Study.describe_run` says."""
        from owtsweep.studies.base.tables import describe_run

        return describe_run(self.contest(), run)

    def list_vary_defaults(self, plain: Plain) -> list[str]:
        """Return the overrides of `vary`: the cell in the middle of the map, and few records."""
        from owtsweep.studies.base.varying.records import list_defaults

        # the study's own check is not due: it may refuse another cell of the map
        config = checked(self.config_type(), self.complete({**plain, "study": self.name}))
        return list_defaults(self.contest(), config)

    def check_vary(self, along: Condition, configs: Mapping[Value, ContestConfig]) -> None:
        """Raise `InputError` if the errors cannot be shown together, as `Study.check_vary` says."""
        from owtsweep.studies.base.varying.records import check

        check(self.contest(), along, configs)

    def vary(self, along: Condition, configs: Mapping[Value, ContestConfig]) -> Varied:
        """Run the records of each configuration, and return the schemes' errors."""
        from owtsweep.studies.base.varying.records import compute
        from owtsweep.studies.base.varying.varied import VariedErrors

        return VariedErrors(compute(self, self.contest(), along, configs))

    def predict_vary(self, configs: Mapping[Value, ContestConfig]) -> tuple[float, float] | None:
        """Return the time and the memory of the cases that are not kept, as `Study` says."""
        from owtsweep.studies.base.varying.records import keep_cases
        from owtsweep.sweep.prepare import forecast

        told = [forecast(self, keep_cases(config)) for config in configs.values()]
        seconds = [each.seconds for each in told if each.seconds is not None]
        memory = [each.memory for each in told if each.memory is not None]
        if len(seconds) < len(told) or not memory:
            return None
        return sum(seconds), max(memory)

    def _find(self, module: str, name: str) -> Any:
        return getattr(import_module(f"{type(self).__module__}.{module}"), name)


class DeclaredStudy(ContestStudy):
    """A study whose package has a `DECLARATION` in its module `declaration`, and `SCHEMES`.

    If `tune` is among its `commands`, it has `SEARCHED` in its module `tuning`.
    """

    commands = ContestStudy.commands | {"estimate"}

    def describe_code(self, config: ContestConfig) -> object:
        """Return what a run stores of its schemes, so that reading it makes no user's class."""
        table = self.scheme_table()
        return table.describe_stored(table.resolve_all(config.schemes))

    def hide_code(self, plain: Plain, described: object) -> Plain:
        """Return the keys of a stored run with a stand-in for each user's scheme."""
        return {**plain, "schemes": self.scheme_table().stand_in(plain.get("schemes"), described)}

    def check(self, config: ContestConfig) -> None:
        """Check also the schemes; raise `InputError` as `ContestStudy.check`."""
        self.scheme_table().resolve_all(config.schemes)
        super().check(config)

    def declaration(self) -> AnyDeclaration:
        return self._find("declaration", "DECLARATION")  # type: ignore[no-any-return]

    def engine(self, config: ContestConfig) -> Engine:
        """Return the study's only engine."""
        from owtsweep.studies.base.engine import DeclaredEngine

        return DeclaredEngine(self.declaration(), self.contest())

    def list_worlds(self, config: ContestConfig) -> dict[str, str]:
        return self.declaration().list_untold(config).tell()

    def check_over(self, config: ContestConfig) -> None:
        from owtsweep.studies.base.axes import check_over

        if config.over is not None:
            made = self.declaration()
            check_over(made.axes, made.list_untold(config), self.check, config)

    def count_trials(self, config: ContestConfig) -> int:
        """Return how many trials `tune` will make; raise `InputError` as `Study.count_trials`."""
        from owtsweep.studies.base.tuning.tuned import list_searched

        return len(list_searched(self._find("tuning", "SEARCHED"), config)) * config.tune.trials

    def predict_tune(self, config: ContestConfig) -> tuple[float, float] | None:
        """Return the time and the memory of search and judgement, as `Study` says."""
        from owtsweep.studies.base.tuning.tuned import predict

        return predict(self.contest(), self._find("tuning", "SEARCHED"), config)

    def tune(self, config: ContestConfig, advance: Callable[[str], None]) -> Tuned:
        """Search the best numbers on training records, as `Study.tune` says."""
        from owtsweep.studies.base.tuning.tuned import tune

        searched = self._find("tuning", "SEARCHED")
        return tune(self.declaration(), self.contest(), searched, config, advance)

    def estimate(self, config: ContestConfig, replicate: int) -> EstimatedRecord:
        """Return a record of the grid's only cell, with the estimates of all schemes."""
        from owtsweep.studies.base.estimating import estimate_record

        return estimate_record(self.declaration(), config, replicate)
