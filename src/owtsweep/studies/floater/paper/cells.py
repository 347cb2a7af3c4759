"""The velocity errors of three schemes in all cells of the study's default maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.studies.composing import compose
from owtsweep.studies.floater.believed import make_setting
from owtsweep.studies.floater.case import Conditions, list_cases
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth
from owtsweep.verdicts.scores import tabulate

if TYPE_CHECKING:
    import pandas as pd

#: The default sweeps.
PLANES = ("delay_bias", "snr_loss", "believed_snr")
CONSISTENT, RIVALS = "KF_CONSISTENT", ("PASSIVE_OBSERVER", "LOWPASS")
#: Records of each cell.
RECORDS = 4


def name_cell(plane: str, config: FloaterConfig, cell: Conditions) -> str:
    """Return the name of a cell, e.g. "delay_bias: delay 2, bias 0.1"."""
    return f"{plane}: " + ", ".join(f"{axis} {getattr(cell, axis):g}" for axis in config.axes)


def score_plane(plane: str, overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Return the velocity errors of a default map, tuning matched (see `evidence.tabulate`)."""
    import pandas as pd

    config = compose(["study=floater", f"plane={plane}", "tuning=matched", *overrides])
    assert isinstance(config, FloaterConfig)
    motions = [make_truth(config, replicate) for replicate in range(RECORDS)]
    tables = []
    for cell in list_cases(config):
        found = {}
        for replicate, motion in enumerate(motions):
            measured = measure(config, motion, cell, replicate)
            setting = make_setting(config, motion, cell)
            found[replicate] = {
                f"velocity_{scheme}": compare(
                    motion.truth,
                    SCHEMES.resolve(scheme).prepare(setting).run(measured),
                    setting.position_sigma,
                    config.record.settled,
                )["velocity"]
                for scheme in (CONSISTENT, *RIVALS)
            }
        tables.append(tabulate(name_cell(plane, config, cell), found))
    return pd.concat(tables, ignore_index=True)
