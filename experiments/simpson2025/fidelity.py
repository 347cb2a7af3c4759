"""Judge what Simpson et al. (2025) say, F1 to F14, and the study's own goals, on several records.

    python -m experiments.simpson2025.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/tower_paper) gets fidelity.md, fidelity.html, scores.csv, table_3.csv,
fidelity_claims.csv and the figures; RECORDS is 10 by default (about a minute each).

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one sensor set-up, one
sea and one gravity, and the statements compare several on the same records.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.command import read_words
from experiments.simpson2025.figures import FIGURES, draw_figures
from experiments.simpson2025.scenarios import Scenario
from experiments.simpson2025.scores import collect
from experiments.simpson2025.table_3 import compare_table, show_table
from owtsweep.io.steps import show_steps
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.page import Heading, Paragraph
from owtsweep.verdicts.report import write_verdicts
from owtsweep.verdicts.score_table import ScoreTable

CLAIMS = Path(__file__).with_name("claims.toml")


def write_report(scores: pd.DataFrame, config: TowerConfig, folder: Path) -> list[Path]:
    """Write fidelity.md, fidelity.html and their tables into a folder; return the files.

    Parameters
    ----------
    scores
        As `scores.collect` returns them.
    config
        The configuration of one scenario, for the page's head.
    folder
        Made if it does not exist.
    """
    record, records = config.record, scores["replicate"].nunique()
    table = compare_table(scores)
    return write_verdicts(
        folder,
        read_claims(CLAIMS),
        [ScoreTable(scores)],
        title="How well the tower study reproduces Simpson et al. (2025)",
        about=(
            f"{records} records of {record.duration:g} s at {record.rate:g} Hz, seed "
            f"{config.seed}, judged after {record.settling:g} s; noise 1 % of each signal's "
            "standard deviation; tuning paper unless said otherwise; damage with the printed S-N "
            "curve (m = 5, log a = 13.617, Goodman with 500 MPa). The truth is a linear beam with "
            "soil, rotor-nacelle and rotor loads of declared statistics, not the paper's Simulink "
            "turbine: absolute numbers (MAE, damage, inputs) cannot agree, ratios and statements "
            "can. Displacements drift without displacement sensors, because inclinometers and "
            "accelerometers do not see position and velocity of the rigid translation: that is "
            "observability, not tuning. Brackets are 95 % intervals of means over the records. "
            "Directions: fa fore-aft, ss side-side."
        ),
        metadata={"study": "tower", "paper": "Simpson et al. (2025)"},
        tables={"scores": scores, "table_3": table},
        middle=[
            Heading("Table 3"),
            Paragraph(
                "Printed number / mean over the records, wind only. MAE in m and rad. The drift of "
                "displacements without displacement sensors is that of an unobservable motion: its "
                "size depends on tuning and seed, and has no other meaning."
            ),
            show_table(table),
        ],
    )


if __name__ == "__main__":
    folder, records, _ = read_words("results/tower_paper", 10)
    with show_steps():
        files = write_report(collect(range(records)), Scenario().compose(), folder)
        files += draw_figures(list(FIGURES), folder / "figures")
    print(*files, sep="\n")
