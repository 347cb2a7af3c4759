"""Plans and runs the blocks of the floater study: some records of one cell and scheme each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.results.status import FAILED, UNABLE
from owtsweep.studies.contest.planning import plan_blocks
from owtsweep.studies.contest.rows import Judgement, make_rows
from owtsweep.studies.floater.believed import make_setting
from owtsweep.studies.floater.case import Conditions, list_cases
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contract import Measured, Scheme, Setting, Unable
from owtsweep.studies.floater.measures import NotFinite, compare
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import resolve
from owtsweep.studies.floater.sections import AXES
from owtsweep.studies.floater.truth import Motion, make_truth
from owtsweep.sweep.study import Block

#: Keys and sections of the configuration on which every row depends.
SHARED = ("seed", "record", "motion", "sensors", "filters")
#: Most records of a block, and most samples of its records: it keeps their measurements. To write
#: and read the file of a block takes as long as a scheme takes for a record.
MOST_RECORDS, MOST_SAMPLES = 10, 500_000


class Case(NamedTuple):
    """One record of a cell: its truth, and what its sensors say."""

    replicate: int
    motion: Motion
    measured: Measured


def plan(config: FloaterConfig) -> list[Block]:
    """Return all blocks of a configuration: one per cell, scheme, and some records."""
    most = max(1, min(MOST_RECORDS, MOST_SAMPLES // config.record.steps))
    return plan_blocks(config, list_cases(config), AXES, _describe_content(config), most)


def run(config: FloaterConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group, i.e. of one cell and some records; yield each with its rows.

    The measurements serve all schemes and tunings.
    """
    conditions = Conditions(**{axis: blocks[0].content[axis] for axis in AXES})
    first, last = blocks[0].content["replicates"]
    cases = []
    for replicate in range(first, last):
        motion = make_truth(config, replicate, conditions.roll)
        cases.append(Case(replicate, motion, measure(config, motion, conditions, replicate)))
    settings: dict[tuple[str, ...], list[Setting]] = {}
    for block in blocks:
        tuning = block.tunings[:1]
        if tuning not in settings:
            chosen = block.choose(config)
            settings[tuning] = [make_setting(chosen, case.motion, conditions) for case in cases]
        scheme = resolve(block.content["scheme"])
        parts = [
            _judge(case, setting, scheme, conditions.believed, config.record.settled)
            for case, setting in zip(cases, settings[tuning], strict=True)
        ]
        yield block, make_rows(block.content, AXES, range(first, last), parts)


def _judge(
    case: Case, setting: Setting, scheme: Scheme, believed: float, settled: int
) -> Judgement:
    """Run a scheme on a record and compare its estimates with the truth.

    `believed` is the variance of noise in the setting over the true one.
    """
    sigma = setting.position_sigma / np.sqrt(believed)
    try:
        estimates = scheme.prepare(setting).run(case.measured)
        return Judgement(compare(case.motion.truth, estimates, sigma, settled))
    except Unable as reason:
        return Judgement.none(UNABLE, reason)
    except NotFinite as reason:
        return Judgement.none(FAILED, reason)


def _describe_content(config: FloaterConfig) -> dict[str, Any]:
    """Return what the rows of every block depend on; a file of motion by its bytes."""
    whole = as_mapping(config)
    content = {name: whole[name] for name in SHARED}
    if config.motion.kind == "recorded" and config.motion.file is not None:
        content["motion"] |= {"file": hash_file(expand_home(config.motion.file))}
    return content
