"""Plans and runs the blocks of the blade study: some records of one cell and scheme each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.results.status import FAILED, UNABLE
from owtsweep.studies.blade.case import Conditions, list_cases
from owtsweep.studies.blade.cases import Case, make_cases
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contract import Scheme, Setting, Unable
from owtsweep.studies.blade.measures import Judged, NotFinite, compare
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.recorded_case import compare_withheld
from owtsweep.studies.blade.schemes import resolve
from owtsweep.studies.blade.sections import AXES
from owtsweep.studies.contest.planning import plan_blocks
from owtsweep.studies.contest.rows import Judgement, make_rows
from owtsweep.sweep.study import Block

#: Keys and sections of the configuration on which every row depends.
SHARED = ("seed", "record", "motion", "boom", "unit", "recorded", "sensors", "filters")
#: Most records of a block, and most samples of its records: it keeps their measurements. To write
#: and read the file of a block takes as long as a scheme takes for a record.
MOST_RECORDS, MOST_SAMPLES = 4, 100_000


def plan(config: BladeConfig) -> list[Block]:
    """Return all blocks of a configuration: one per cell, scheme, and some records."""
    most = max(1, min(MOST_RECORDS, MOST_SAMPLES // config.record.steps))
    return plan_blocks(config, list_cases(config), AXES, _describe_content(config), most)


def run(config: BladeConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group, i.e. of one cell and some records; yield each with its rows.

    The measurements serve all schemes and tunings.
    """
    conditions = Conditions(**{axis: blocks[0].content[axis] for axis in AXES})
    first, last = blocks[0].content["replicates"]
    last_outage = find_last_outage(config, conditions.outage)
    window = Judged(config.record.settled, last_outage)
    cases = make_cases(config, conditions, range(first, last))
    settings: dict[tuple[str, ...], list[Setting]] = {}
    for block in blocks:
        tuning = block.tunings[:1]
        if tuning not in settings:
            chosen = block.choose(config)
            settings[tuning] = [case.tell(chosen, conditions) for case in cases]
        scheme = resolve(block.content["scheme"])
        parts = [
            _judge(case, setting, scheme, window)
            for case, setting in zip(cases, settings[tuning], strict=True)
        ]
        yield block, make_rows(block.content, AXES, range(first, last), parts)


def _judge(case: Case, setting: Setting, scheme: Scheme, window: Judged) -> Judgement:
    """Run a scheme on a record and compare its estimates with the truth."""
    try:
        estimates = scheme.prepare(setting).run(case.measured)
        found = compare(case.truth, estimates, window)
        if case.withheld is not None:
            off = compare_withheld(estimates, case.withheld, case.geometry)
            found |= {} if off is None else {"withheld": off}
        return Judgement(found)
    except Unable as reason:
        return Judgement.none(UNABLE, reason)
    except NotFinite as reason:
        return Judgement.none(FAILED, reason)


def _describe_content(config: BladeConfig) -> dict[str, Any]:
    """Return what the rows of every block depend on."""
    whole = as_mapping(config)
    content = {name: whole[name] for name in SHARED}
    recorded = config.recorded
    if recorded.imu is not None:
        imu, *gnss = (hash_file(expand_home(name)) for name in (recorded.imu, *recorded.gnss))
        content["recorded"] |= {"imu": imu, "gnss": gnss}
        content["reference"] = config.grid.sigma[0]
    return content
