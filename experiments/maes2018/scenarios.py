"""What is run to judge the paper's statements and the study's goals: one cell, several schemes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.command import read_data
from owtsweep.studies.blade.cases import make_setting, make_world, observe
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.contract import Estimates, Measured, Setting, Truth
from owtsweep.studies.blade.measures import Judged
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.schemes import SCHEMES
from owtsweep.studies.registry import compose

#: Overrides: the paper's system, outages, and name -> what is wrong with the reference system.
CELL, COASTING, REFERENCE = read_data(__file__).values()


@dataclass(frozen=True)
class Record:
    """A record of a scenario: truth, measurements, what schemes know, and which samples count.

    `replicate` is its number.
    """

    replicate: int
    config: BladeConfig
    truth: Truth
    measured: Measured
    setting: Setting
    judged: Judged

    def run(self, scheme: str) -> Estimates:
        """Return what a scheme says of the record."""
        estimates: Estimates = SCHEMES.resolve(scheme).prepare(self.setting).run(self.measured)
        return estimates


def make_record(words: Sequence[str], replicate: int) -> Record:
    """Make a record of the paper's system with overrides; `replicate` is its number."""
    return simulate(compose_cell(words), replicate)


def compose_cell(words: Sequence[str]) -> BladeConfig:
    """Return the configuration of the paper's system with overrides."""
    config = compose([*CELL, *words])
    assert isinstance(config, BladeConfig)
    return config


def simulate(config: BladeConfig, replicate: int) -> Record:
    """Make the record with a number of the only cell of a configuration."""
    (cell,) = CONTEST.list_cells(config)
    case = observe(config, cell, make_world(config, cell, replicate))
    judged = Judged(config.record.settled, find_last_outage(config, cell["outage"]))
    setting = make_setting(config, cell, case.start)
    return Record(replicate, config, case.truth, case.measured, setting, judged)
