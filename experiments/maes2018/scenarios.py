"""What is run to judge the paper's statements and the study's goals: one cell, several schemes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from owtsweep.studies.base.axes import list_cells
from owtsweep.studies.blade.cases import make_world, observe
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.contract import Estimates, Measured, Setting, Truth
from owtsweep.studies.blade.measures import Judged
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.schemes import SCHEMES
from owtsweep.studies.composing import compose

#: The paper's system: fibre-optic gyroscopes, fixes of 6 mm, no outage; all told the truth.
CELL = (
    "study=blade", "axes=[sigma,outage]", "unit=fog", "tuning=matched", "grid.sigma=[0.006]",
    "grid.outage=[0]",
)  # fmt: skip
_CLOCK, _STRETCH = "sensors.prism_offset=0.1", "sensors.stretch=0.05"
_SAG = "motion.bending.sag=0.03"
#: What is wrong with the reference system -> overrides. The paper's sentences name all of it.
REFERENCE = {
    "noise only": (),
    "late clock": (_CLOCK,),
    "bent blade": (_STRETCH,),
    "both": (_CLOCK, _STRETCH),
    "sagging blade": (_SAG,),
    "sag and late clock": (_CLOCK, _SAG),
}
#: Outages of 10 s, many in a record.
COASTING = ("grid.outage=[10]", "sensors.outage_every=30")


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
    (cell,) = list_cells(CONTEST.axes, config.grid)
    case = observe(config, cell, make_world(config, cell, replicate))
    judged = Judged(config.record.settled, find_last_outage(config, cell["outage"]))
    return Record(replicate, config, case.truth, case.measured, case.tell(config, cell), judged)
