"""Scores of records, by which the paper's statements and the study's goals are judged.

They are those of the scenarios, and the velocity errors of three schemes in all cells of the
study's default maps.
"""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from joblib import delayed

from experiments.command import compute
from experiments.mehammer2018.scenarios import OWN, PAPER, run_composed
from experiments.mehammer2018.scores import score
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth
from owtsweep.studies.registry import compose

#: The default sweeps.
PLANES = ("delay_bias", "snr_loss", "believed_snr")
CONSISTENT, RIVALS = "KF_CONSISTENT", ("PASSIVE_OBSERVER", "LOWPASS")
#: Records of each cell of the maps.
RECORDS = 4
#: Most records of each of the paper's tests: they scatter little, and those of the decay are long.
MOST = 20


def collect(
    replicates: Sequence[int], overrides: Sequence[str] = ()
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Run all scenarios and the default maps; return the scores of both.

    Columns are those of `score_scenario` and of `score_plane`. Records have the numbers
    `replicates` (of which the paper's tests take `MOST`), but those of maps. Scenarios run side by
    side, in as many processes as there are cores.
    """
    jobs = {name: delayed(score_scenario)(name, replicates[:MOST], overrides) for name in PAPER}
    jobs |= {name: delayed(score_scenario)(name, replicates, overrides) for name in OWN}
    jobs |= {plane: delayed(score_plane)(plane, overrides) for plane in PLANES}
    found = compute({f"{name}: judged": job for name, job in jobs.items()})
    scores, cells = found[: -len(PLANES)], found[-len(PLANES) :]
    return pd.concat(scores, ignore_index=True), pd.concat(cells, ignore_index=True)


def score_scenario(name: str, replicates: Sequence[int], overrides: Sequence[str]) -> pd.DataFrame:
    """Return the scores of a scenario on all records.

    Columns: scenario, scheme, measure, replicate, value.
    """
    scenario = (PAPER | OWN)[name]
    config = scenario.compose(overrides)  # once, not per record: it takes .1 s
    rows = [
        (name, scheme, measure, replicate, value)
        for replicate in replicates
        for scheme, outcome in run_composed(scenario, config, replicate).items()
        for measure, value in score(outcome).items()
    ]
    return pd.DataFrame(rows, columns=["scenario", "scheme", "measure", "replicate", "value"])


def name_cell(config: FloaterConfig, cell: Cell) -> str:
    """Return the name of a cell, e.g. "delay 2, bias 0.1"."""
    return ", ".join(f"{axis} {cell[axis]:g}" for axis in config.axes)


def score_plane(plane: str, overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Return the velocity errors of a default map, tuning matched.

    Columns: plane, cell, scheme, replicate, value.
    """
    config = compose(["study=floater", f"plane={plane}", "tuning=matched", *overrides])
    assert isinstance(config, FloaterConfig)
    motions = [make_truth(config, replicate) for replicate in range(RECORDS)]
    rows = []
    for cell in CONTEST.list_cells(config):
        name = name_cell(config, cell)
        for motion in motions:
            measured = measure(config, motion, cell)
            setting = make_setting(config, motion, cell)
            for scheme in (CONSISTENT, *RIVALS):
                error = compare(
                    motion.truth,
                    SCHEMES.resolve(scheme).prepare(setting).run(measured),
                    setting.position_sigma,
                    config.record.settled,
                )["velocity"]
                rows.append((plane, name, scheme, motion.replicate, error))
    return pd.DataFrame(rows, columns=["plane", "cell", "scheme", "replicate", "value"])


def list_lost_cells(scores: pd.DataFrame) -> list[str]:
    """Return the cells in which a rival's mean velocity error is not above the consistent one's."""
    means = scores.pivot_table("value", ["plane", "cell"], "scheme", sort=False).reset_index()
    return [
        f"{row['plane']}: {row['cell']} "
        f"({rival} {row[rival]:.3f}, {CONSISTENT} {row[CONSISTENT]:.3f})"
        for row in means.to_dict("records")
        for rival in RIVALS
        if row[rival] <= row[CONSISTENT]
    ]
