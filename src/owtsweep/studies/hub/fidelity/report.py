"""Write the fidelity report of a run: tables, figures, Markdown and HTML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.io.steps import tell_step
from owtsweep.studies.hub import published
from owtsweep.studies.hub.conditions import CONDITIONS, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity.contents import FREEDOM, document
from owtsweep.studies.hub.fidelity.evidence import SCHEMES, HubEvidence
from owtsweep.studies.hub.fidelity.history_errors import measure_history_errors
from owtsweep.studies.hub.fidelity.numbers import compare_numbers
from owtsweep.studies.hub.fidelity.plots import draw_boundaries
from owtsweep.studies.hub.fidelity.statements import (
    OF_FIGURES,
    STATEMENTS,
    TABLE_CELLS,
    X_ALONE,
)
from owtsweep.studies.hub.fidelity.summaries import fidelity_table
from owtsweep.studies.hub.resolving import scheme_names
from owtsweep.verdicts import plots, report
from owtsweep.verdicts.consistency import judge_consistency
from owtsweep.verdicts.statements import JudgedStatement, judge, tabulate_claims

if TYPE_CHECKING:
    import pandas as pd


#: Measure of the paper's tables -> its label in figures.
MEASURES = {"x": "x", "y": "y", "vx": "v$_x$", "vy": "v$_y$"}
#: Title of a panel -> its measures.
PANELS = {
    "MSE of x and y (m²)": ("x", "y"),
    "MSE of v$_x$ and v$_y$ (m²/s²)": ("vx", "vy"),
}


def judge_all(evidence: HubEvidence) -> list[JudgedStatement]:
    """Judge the statements F1 to F11 of Ren et al. (2019) by the results of a run."""
    facts = published.facts()
    return judge(dict(zip(facts["id"], facts["statement"], strict=True)), STATEMENTS, evidence)


def judge_along_x(evidence: HubEvidence) -> list[JudgedStatement]:
    """Judge F1 to F5, which are on figures 15 to 18 of Ren et al. (2019), in x alone."""
    facts = published.facts().set_index("id")["statement"]
    judged = judge({name: facts[name] for name in OF_FIGURES}, STATEMENTS, evidence.along_x)
    return [replace(statement, name=f"{statement.name}{X_ALONE}") for statement in judged]


def write_report(
    config: HubConfig, rows: pd.DataFrame, folder: Path, metadata: Mapping[str, str]
) -> list[Path]:
    """Compare a run with Ren et al. (2019) and write the report on this comparison.

    Parameters
    ----------
    config
        The run's configuration; the time histories at 3.8 s are simulated with it.
    rows
        The run's cases, as `Run.cases` returns them.
    folder
        The folder for the report, which is made if it does not exist. The files are fidelity.csv,
        fidelity_numbers.csv, fidelity_claims.csv, consistency.csv, fidelity.md, fidelity.html and
        figures/.
    metadata
        Texts by name to store inside the figures' files. The text "folder" is the run's name in
        the report.

    Returns
    -------
    list of Path
        All files written.
    """
    tell_step("time histories of HME1 and HME2")
    evidence = HubEvidence(
        rows=rows,
        conditions=CONDITIONS,
        grid=get_grid(config),
        schemes=tuple(scheme_names(config)),
        rivals=SCHEMES,
        window=config.measures.window,
        history_errors=measure_history_errors(config),
    )
    tell_step("published numbers and statements")
    numbers, judged = compare_numbers(evidence), judge_all(evidence)
    along_x = judge_along_x(evidence)
    tables = {
        "fidelity": fidelity_table(evidence, numbers, judged, along_x),
        "fidelity_numbers": numbers,
        "fidelity_claims": tabulate_claims([*judged, *along_x]),
        "consistency": judge_consistency(evidence, FREEDOM),
    }
    name, amplitudes = metadata["folder"], config.grid.amplitude
    return report.write_report(
        folder,
        title=f"Fidelity of {name}",
        tables=tables,
        figures={
            "published_against_reproduced": lambda: plots.scatter(numbers, SCHEMES, PANELS),
            "ratios": lambda: plots.ratios(numbers, SCHEMES, MEASURES, TABLE_CELLS),
            "boundaries": lambda: draw_boundaries(evidence.boundaries, amplitudes),
        },
        contents=partial(document, name, config, evidence, tables, judged, along_x),
        metadata=metadata,
    )
