"""The fidelity report of a run: tables, figures, Markdown and HTML."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.studies.hub import published, scheme_names
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity import contents, plots
from owtsweep.studies.hub.fidelity.boundaries import all_boundaries
from owtsweep.studies.hub.fidelity.consistency import consistency
from owtsweep.studies.hub.fidelity.evidence import Evidence
from owtsweep.studies.hub.fidelity.histories import make_histories
from owtsweep.studies.hub.fidelity.history_statements import HISTORY_STATEMENTS
from owtsweep.studies.hub.fidelity.numbers import compare_numbers
from owtsweep.studies.hub.fidelity.statements import STATEMENTS
from owtsweep.studies.hub.fidelity.summaries import fidelity_table
from owtsweep.verdicts import report
from owtsweep.verdicts.statements import JudgedStatement, judge, tabulate_claims

if TYPE_CHECKING:
    import pandas as pd


def collect(config: HubConfig, rows: pd.DataFrame) -> Evidence:
    """What a run has to say about the paper; simulates its time histories at 3.8 s.

    Parameters
    ----------
    config
        The run's configuration.
    rows
        The run's cases, as `Run.cases` returns them.
    """
    return Evidence(
        rows=rows,
        schemes=tuple(scheme_names(config)),
        periods=tuple(config.grid.natural_period),
        amplitudes=tuple(config.grid.amplitude),
        window=config.measures.window,
        histories=make_histories(config),
    )


def judge_all(evidence: Evidence) -> list[JudgedStatement]:
    """F1 to F11."""
    facts = published.facts()
    texts = dict(zip(facts["id"], facts["statement"], strict=True))
    return judge(texts, {**STATEMENTS, **HISTORY_STATEMENTS}, evidence)


def write_report(
    config: HubConfig,
    rows: pd.DataFrame,
    folder: Path,
    *,
    name: str,
    metadata: Mapping[str, str] | None = None,
) -> list[Path]:
    """Judge a run against the paper and write everything about it.

    Parameters
    ----------
    config, rows
        As for `collect`.
    folder
        Made if it does not exist: fidelity.csv, fidelity_numbers.csv, fidelity_claims.csv,
        consistency.csv, fidelity.md, fidelity.html and figures/.
    name
        What to call the run.
    metadata
        Stored inside the figures.

    Returns
    -------
    list of Path
        The files.
    """
    evidence = collect(config, rows)
    numbers, judged = compare_numbers(evidence), judge_all(evidence)
    boundaries, consistent = all_boundaries(evidence), consistency(evidence)
    table = fidelity_table(evidence, numbers, judged, boundaries)
    return report.write_report(
        folder,
        name="fidelity",
        title=f"Fidelity of {name}",
        tables={
            "fidelity": table,
            "fidelity_numbers": numbers,
            "fidelity_claims": tabulate_claims(judged),
            "consistency": consistent,
        },
        figures={
            "published_against_reproduced": lambda: plots.scatter(numbers),
            "ratios": lambda: plots.ratios(numbers),
            "boundaries": lambda: plots.boundary_plot(boundaries, evidence.amplitudes),
        },
        contents=lambda pictures: contents.document(
            contents.Contents(
                name=name,
                config=config,
                evidence=evidence,
                table=table,
                numbers=numbers,
                judged=judged,
                consistency=consistent,
                pictures=pictures,
            )
        ),
        metadata=metadata,
    )
