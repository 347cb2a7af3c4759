"""Judge what Mehammer et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python experiments/floater/fidelity.py [FOLDER] [RECORDS]

FOLDER (default: results/floater_paper) gets fidelity.md, fidelity.html, scores.csv,
stored_tests.csv, fidelity_claims.csv and the figures; RECORDS is 100 by default.

The command `owtsweep fidelity RUN` is no way to this: a run of the study has one truth and one way
of losses, and the statements compare several on the same records.
"""

import sys
from pathlib import Path

from owtsweep.io.steps import show_steps
from owtsweep.studies.floater.paper.figures import FIGURES, draw_figures
from owtsweep.studies.floater.paper.judging import OWN, collect
from owtsweep.studies.floater.paper.report import write_report
from owtsweep.verdicts.scores import Scores

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/floater_paper")
records = int(sys.argv[2]) if len(sys.argv) > 2 else 100
with show_steps():
    scores = Scores(collect(range(records)))
    files = write_report(scores, OWN["20 dB"].compose(), folder)
    files += draw_figures(list(FIGURES), folder / "figures")
for file in files:
    print(file)
