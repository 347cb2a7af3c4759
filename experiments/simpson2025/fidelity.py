"""Judge what Simpson et al. (2025) say, F1 to F14, and the study's own goals, on several records.

    python -m experiments.simpson2025.fidelity [FOLDER] [RECORDS]

FOLDER (default: results/tower_paper) gets fidelity.md, fidelity.html, scores.csv, table_3.csv,
fidelity_claims.csv and the figures; RECORDS is 10 by default (about a minute each).

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one sensor set-up, one
sea and one gravity, and the statements compare several on the same records.
"""

import sys
from pathlib import Path

from experiments.simpson2025.evidence import Scores
from experiments.simpson2025.figures import FIGURES, draw_figures
from experiments.simpson2025.report import write_report
from experiments.simpson2025.scenarios import Scenario
from experiments.simpson2025.scores import collect
from owtsweep.io.steps import show_steps

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tower_paper")
records = int(sys.argv[2]) if len(sys.argv) > 2 else 10
with show_steps():
    scores = Scores(collect(range(records)))
    files = write_report(scores, Scenario().compose(), folder)
    files += draw_figures(list(FIGURES), folder / "figures")
for file in files:
    print(file)
