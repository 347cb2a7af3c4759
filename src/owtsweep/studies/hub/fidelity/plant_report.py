"""Write the fidelity report of a run with motion=plant: the statements on time histories alone.

The tables and the map of Ren et al. (2019) have natural periods and amplitudes as conditions, which
a structure under waves has not. F9 and F11 concern time histories, which the paper simulated with
its structure under waves; so the plant is nearer to them than a motion of a spectrum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.io.steps import tell_step
from owtsweep.studies.hub import published
from owtsweep.studies.hub.conditions import get_conditions, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity.contents import DEFINITIONS
from owtsweep.studies.hub.fidelity.evidence import SCHEMES, HubEvidence
from owtsweep.studies.hub.fidelity.history_errors import MOST_REPLICATES, measure_history_errors
from owtsweep.studies.hub.fidelity.statements import STATEMENTS
from owtsweep.studies.hub.origin import describe_in_a_line
from owtsweep.studies.hub.resolving import scheme_names
from owtsweep.verdicts import report, sections
from owtsweep.verdicts.page import Block, Heading, Paragraph
from owtsweep.verdicts.statements import JudgedStatement, judge, tabulate_claims

if TYPE_CHECKING:
    import pandas as pd

#: The statements on time histories.
NAMES = ("F9", "F11")


def write_report(
    config: HubConfig, rows: pd.DataFrame, folder: Path, metadata: Mapping[str, str]
) -> list[Path]:
    """Judge F9 and F11 of Ren et al. (2019) on the plant; write the verdicts and their numbers.

    Parameters
    ----------
    config, rows
        The run's configuration, and its cases as `Run.cases` returns them.
    folder
        The folder for fidelity_claims.csv, fidelity.md and fidelity.html; it is made if it does not
        exist.
    metadata
        Texts by name. The text "folder" is the run's name in the report.

    Returns
    -------
    list of Path
        All files written.

    Raises
    ------
    InputError
        If the run lacks HME1 or HME2.
    """
    tell_step("time histories of HME1 and HME2")
    errors = measure_history_errors(config)
    require(
        errors is not None,
        "schemes: `fidelity` judges HME1 and HME2 on the plant; run a sweep with "
        "schemes=[HME1,HME2]",
    )
    assert errors is not None
    evidence = HubEvidence(
        rows=rows,
        conditions=get_conditions(config),
        grid=get_grid(config),
        schemes=tuple(scheme_names(config)),
        rivals=SCHEMES,
        window=config.measures.window,
        history_errors=errors,
    )
    facts = published.facts().set_index("id")["statement"]
    judged = judge({name: facts[name] for name in NAMES}, STATEMENTS, evidence)
    name = metadata["folder"]
    return report.write_report(
        folder,
        title=f"Fidelity of {name}",
        tables={"fidelity_claims": tabulate_claims(judged)},
        figures={},
        contents=partial(_list_contents, name, config, errors.where, judged),
        metadata=metadata,
    )


def _list_contents(
    name: str,
    config: HubConfig,
    where: str,
    judged: Sequence[JudgedStatement],
    pictures: Mapping[str, Path],
) -> list[Block]:
    count = min(config.grid.replicates, MOST_REPLICATES)
    return [
        Heading(f"What run {name} says about the time histories of Ren et al. (2019)", 1),
        Paragraph(
            f"{describe_in_a_line(config)}. Motion: {where}, in place of the natural period of "
            f"3.8 s and the amplitude of 0.5 m that the tests name; {count} "
            f"record{'s' * (count != 1)}. The other statements of the paper need natural periods "
            "and amplitudes as conditions, so a run with motion=plant cannot judge them."
        ),
        *sections.statement_section(judged, DEFINITIONS),
    ]
