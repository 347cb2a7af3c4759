"""Judge what Maes et al. (2018) say, F1 to F10, and the study's own goals, on many records.

    python experiments/blade/fidelity.py [FOLDER] [RECORDS]

FOLDER (default: results/blade_paper) gets fidelity.md, fidelity.html, scores.csv and
fidelity_claims.csv; RECORDS is 100 by default.
"""

import sys
from pathlib import Path

from owtsweep.io.steps import show_steps
from owtsweep.studies.blade.paper.judging import collect
from owtsweep.studies.blade.paper.report import write_report
from owtsweep.verdicts.scores import Scores

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/blade_paper")
records = int(sys.argv[2]) if len(sys.argv) > 2 else 100
with show_steps():
    files = write_report(Scores(collect(range(records))), folder)
for file in files:
    print(file)
