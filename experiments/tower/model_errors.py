"""Map which scheme bears which error of its model, with which sensors.

    python -m experiments.tower.model_errors [FOLDER] [RECORDS] [OVERRIDE ...]

FOLDER (default: results/tower_model_errors) gets model_errors.csv, the errors of all schemes, and
two maps: model_errors_damage.png and model_errors_base_moment.png. RECORDS is 2 by default (about a
minute each). An OVERRIDE is one of the tower study's keys, e.g. sea=waves; tuning=matched unless
another is given.
"""

import sys
from pathlib import Path

from owtsweep.figures import best_scheme_map, style
from owtsweep.figures.drawings import save_figure
from owtsweep.io.steps import show_steps
from owtsweep.io.tables import write_table
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise
from owtsweep.studies.composing import compose
from owtsweep.studies.tower.measures import CRITERIA, WINDOW
from owtsweep.studies.tower.model_errors import CONDITIONS, ERRORS, NOISE, SCHEMES, SETUPS, collect
from owtsweep.studies.tower.origin import describe_truth

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tower_model_errors")
records = int(sys.argv[2]) if len(sys.argv) > 2 else 2
overrides = ["tuning=matched", *sys.argv[3:]]
config = compose(["study=tower", *overrides])
with show_steps():
    rows = collect(range(records), overrides)
cube = Cube.of_rows(
    rows, SCHEMES, CONDITIONS, {"sensors": SETUPS, "model_error": list(ERRORS)},
    measures=["damage", "base_moment"],
)  # fmt: skip
folder.mkdir(parents=True, exist_ok=True)
write_table(folder, "model_errors", summarise(cube))
for criterion in ("damage", "base_moment"):
    best = find_best_schemes(cube, WINDOW, [criterion])

    def draw(best=best, criterion=criterion):
        """Draw the map of one criterion."""
        figure = best_scheme_map.draw(
            best, SCHEMES, CONDITIONS, criterion=criterion, window=WINDOW,
            tuning=config.tuning_name, quantity=CRITERIA[criterion], score="error",
            replicates=records,
        )  # fmt: skip
        style.add_origin(
            figure,
            f"Truth: {describe_truth(config)}; {NOISE:g} % noise, soil of the model right; "
            f"seed {config.seed}.",
        )
        return figure

    for file in save_figure(draw, None)(folder, f"model_errors_{criterion}"):
        print(file)
