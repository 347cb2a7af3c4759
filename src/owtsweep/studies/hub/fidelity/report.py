"""The fidelity report of a run: tables, figures, Markdown and HTML."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.figures import style
from owtsweep.io.files import write_atomically
from owtsweep.io.tables import write_table
from owtsweep.studies.hub import scheme_names
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.fidelity import contents, plots
from owtsweep.studies.hub.fidelity.boundaries import all_boundaries
from owtsweep.studies.hub.fidelity.consistency import consistency
from owtsweep.studies.hub.fidelity.evidence import Evidence
from owtsweep.studies.hub.fidelity.histories import make_histories
from owtsweep.studies.hub.fidelity.numbers import compare_numbers
from owtsweep.studies.hub.fidelity.summaries import fidelity_table
from owtsweep.verdicts.judgement import claims_table, judge
from owtsweep.verdicts.page import to_html, to_markdown

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


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
    numbers, judged, boundaries = (
        compare_numbers(evidence),
        judge(evidence),
        all_boundaries(evidence),
    )
    table = fidelity_table(evidence, numbers, judged, boundaries)
    consistent = consistency(evidence)
    folder.mkdir(parents=True, exist_ok=True)
    files = [
        write_table(folder, "fidelity", table),
        write_table(folder, "fidelity_numbers", numbers),
        write_table(folder, "fidelity_claims", claims_table(judged)),
        write_table(folder, "consistency", consistent),
    ]
    with style.context():
        figures = {
            "published_against_reproduced": plots.scatter(numbers),
            "ratios": plots.ratios(numbers),
            "boundaries": plots.boundary_plot(boundaries, evidence.amplitudes),
        }
        pictures = {stem: _save(figure, folder, stem, metadata) for stem, figure in figures.items()}
    files += [file for saved in pictures.values() for file in saved]
    blocks = contents.document(
        contents.Findings(
            name=name,
            config=config,
            evidence=evidence,
            table=table,
            numbers=numbers,
            judged=judged,
            consistency=consistent,
            pictures={stem: saved[0] for stem, saved in pictures.items()},
        )
    )
    texts = {
        "fidelity.md": to_markdown(blocks, folder),
        "fidelity.html": to_html(blocks, f"Fidelity of {name}"),
    }
    for file, text in texts.items():
        write_atomically(folder / file, text)
    return [*files, *(folder / file for file in texts)]


def _save(
    figure: Figure, folder: Path, stem: str, metadata: Mapping[str, str] | None
) -> list[Path]:
    return style.save(figure, folder / "figures", stem, metadata)
