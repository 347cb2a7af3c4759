"""Hold a run against every number and statement of Ren et al. (2019).

    python -m experiments.ren2019.fidelity RUN

RUN is the folder of a run of the hub study. Its subfolder fidelity/ gets fidelity.md,
fidelity.html, fidelity.csv, fidelity_numbers.csv, fidelity_claims.csv, consistency.csv and the
figures; with several tunings, fidelity/<tuning>/. The time histories at 3.8 s (F9 and F11) are
simulated with the run's configuration. Of a run with motion=plant only these are judged: the other
statements need natural periods and amplitudes as conditions.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import cast

import pandas as pd

import owtsweep
from experiments.ren2019 import plots
from experiments.ren2019.consistency import judge_consistency
from experiments.ren2019.contents import TEXTS, document
from experiments.ren2019.evidence import Evidence
from experiments.ren2019.histories import MOST_REPLICATES, measure_histories
from experiments.ren2019.numbers import compare_numbers
from experiments.ren2019.summaries import X_ALONE, fidelity_table
from owtsweep.errors import InputError
from owtsweep.figures.drawings import draw_each, save_figure
from owtsweep.io.tables import write_table
from owtsweep.io.terminal import show_steps, tell_step
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import describe_in_a_line
from owtsweep.studies.hub.worlds import find_world
from owtsweep.sweep.runs import Run
from owtsweep.verdicts import report
from owtsweep.verdicts.claims_file import Statement, read_claims
from owtsweep.verdicts.inference import JudgedStatement, tabulate_claims
from owtsweep.verdicts.judge import judge
from owtsweep.verdicts.score_table import ScoreTable

CLAIMS = read_claims(Path(__file__).with_name("claims.toml"))
#: The statements on figures 15 to 18, which are judged in x alone too: section 5.3 of the paper
#: does not say whether these figures show x, y or x + y.
OF_FIGURES = CLAIMS.statements[:5]
#: The statements on time histories.
OF_HISTORIES = tuple(s for s in CLAIMS.statements if s.name in ("F9", "F11"))


def judge_all(scores: Sequence[ScoreTable]) -> list[JudgedStatement]:
    """Judge the statements F1 to F11 by the scores of a run, and of its time histories."""
    return judge(CLAIMS.statements, scores, CLAIMS)


def judge_along_x(scores: Sequence[ScoreTable]) -> list[JudgedStatement]:
    """Judge F1 to F5 in x alone."""
    return judge([take_x(statement) for statement in OF_FIGURES], scores, CLAIMS)


def take_x(statement: Statement) -> Statement:
    """Return a statement with the MSE of x in place of the position MSE."""
    in_x = {"measure": ("x",)}
    claims = []
    for claim in statement.claims:
        parts = [part.model_copy(update={"select": part.select | in_x}) for part in claim.parts]
        claims.append(claim.model_copy(update={"parts": tuple(parts)}))
    name = f"{statement.name}{X_ALONE}"
    return statement.model_copy(update={"name": name, "claims": tuple(claims)})


def write_report(run: Run, folder: Path) -> list[Path]:
    """Compare a run of one tuning with the paper; write the report, and return its files."""
    config, name = cast(HubConfig, run.config), run.metadata()["folder"]
    tell_step("time histories of HME1 and HME2")
    histories = measure_histories(config)
    if not find_world(config).has_spectrum:
        return _write_report_of_plant(run, folder, histories)
    tell_step("published numbers and statements")
    evidence = Evidence.of_run(run)
    scores = [evidence.scores, *([] if histories is None else [ScoreTable(histories)])]
    numbers, judged, along_x = compare_numbers(evidence), judge_all(scores), judge_along_x(scores)
    tables = {
        "fidelity": fidelity_table(evidence, numbers, judged, along_x),
        "fidelity_numbers": numbers,
        "fidelity_claims": tabulate_claims([*judged, *along_x]),
        "consistency": judge_consistency(evidence),
    }
    amplitudes = config.grid.amplitude
    figures = {
        "published_against_reproduced": partial(plots.scatter, numbers),
        "ratios": partial(plots.ratios, numbers),
        "boundaries": lambda: plots.draw_boundaries(evidence.boundaries, amplitudes),
    }
    drawings = {stem: save_figure(draw, run.metadata()) for stem, draw in figures.items()}
    folder.mkdir(parents=True, exist_ok=True)
    files = [write_table(folder, stem, table) for stem, table in tables.items()]
    drawn = draw_each(drawings, folder / "figures", None)
    pictures = {path.stem: path for path in drawn if path.suffix == ".png"}
    blocks = document(name, config, evidence, tables, judged, along_x, CLAIMS.note, pictures)
    return [*files, *drawn, *report.write_page(folder, f"Fidelity of {name}", blocks)]


def _write_report_of_plant(run: Run, folder: Path, histories: pd.DataFrame | None) -> list[Path]:
    """Judge F9 and F11 on a structure under waves; write the verdicts and their numbers."""
    if histories is None:
        raise InputError(
            "schemes: the statements on time histories are about HME1 and HME2; run a sweep with "
            "schemes=[HME1,HME2]"
        )
    config, name = cast(HubConfig, run.config), run.metadata()["folder"]
    count = min(config.grid.greatest, MOST_REPLICATES)
    records = f"{count} record{'s' * (count != 1)}"
    motion = histories["history"].iloc[0]
    about = TEXTS["plant"].format(run=describe_in_a_line(config), motion=motion, records=records)
    return report.write_verdicts(
        folder,
        CLAIMS.model_copy(update={"statements": OF_HISTORIES}),
        [ScoreTable(histories)],
        title=f"What run {name} says about the time histories of Ren et al. (2019)",
        about=about,
    )


def main(path: str) -> None:
    """Write the report of each tuning of a run; print where."""
    run = owtsweep.load(path)
    if run.study.name != "hub":
        sys.exit(f"{run.folder}: this is a run of study {run.study.name}; use one of the hub's")
    for tuning, part in run.by_tuning().items():
        folder = run.place / "fidelity" / tuning
        with show_steps():
            files = write_report(part, folder)
        print(f"{len(files)} files: {folder / 'fidelity.html'}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m experiments.ren2019.fidelity RUN")
    try:
        main(sys.argv[1])
    except InputError as error:
        sys.exit(str(error))
