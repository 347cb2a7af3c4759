"""Table 3 of Simpson et al. (2025) beside the study's numbers: 72 of each.

    python experiments/tower/table_3.py [RECORDS]

prints "printed / mean over RECORDS" (default: 2 records) in Markdown. MAE is in m and rad.
"""

import sys

import pandas as pd

from owtsweep.io import markdown
from owtsweep.studies.tower.paper.evidence import Scores
from owtsweep.studies.tower.paper.judging import WIND
from owtsweep.studies.tower.paper.scenarios import run_scenarios
from owtsweep.studies.tower.paper.scores import tabulate
from owtsweep.studies.tower.paper.table_3 import compare_table, show_table

tables = []
for replicate in range(int(sys.argv[1]) if len(sys.argv) > 1 else 2):
    for _, outcomes in run_scenarios(WIND.values(), replicate):
        tables.append(tabulate(list(outcomes.values())))
shown = show_table(compare_table(Scores(pd.concat(tables))))
print(markdown.table(shown.columns, shown.rows, numbers=shown.numbers))
