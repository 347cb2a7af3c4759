"""Compare runs of one study: tables, figures and words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.common import (
    Common,
    arrange_samples,
    expand_common,
    find_best,
    find_common,
    find_unpaired,
)
from owtsweep.comparing.comparison import Candidate, Comparison, Findings
from owtsweep.comparing.values import show
from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


def compare(
    comparison: Comparison,
    folder: Path,
    describe: Callable[[Candidate], Aspects],
    *,
    metadata: Mapping[str, str],
) -> Findings:
    """Tables, figures and words on how best scheme, boundary and errors move between runs.

    Parameters
    ----------
    comparison
        The runs and which of them are held against each other.
    folder
        Where figures go.
    describe
        What the study says of a run.
    metadata
        What figures carry.

    Raises
    ------
    InputError
        If the runs share no cell or scheme, or are judged by different criteria.
    """
    import pandas as pd

    from owtsweep.comparing import report

    runs = comparison.runs
    aspects = [describe(run) for run in runs]
    shared = find_common(runs, aspects)
    notes = list(shared.notes)
    values = [expand_common(run, shared) for run in runs]
    best = [find_best(run, told, shared) for run, told in zip(runs, aspects, strict=True)]
    boundaries, no_boundary = _find_boundaries(runs, aspects, shared)
    notes += no_boundary
    pair_tables, unpaired = _compare_pairs(comparison, aspects, shared, values, best)
    notes += unpaired
    identities = [_identify(run, i) for i, run in enumerate(runs)]
    tables = {
        "runs": pd.DataFrame(identities).drop(columns="index"),
        "best_schemes": _with_values(
            [
                (identities[i], row)
                for i, table in enumerate(best)
                for row in table.to_dict("records")
            ]
        ),
        "boundaries": _with_values(
            [(identities[row["index"]], row) for row in boundaries.to_dict("records")]
        ),
        **pair_tables,
    }
    if shared.boundary is None:
        tables = {name: table for name, table in tables.items() if not name.startswith("boundar")}
    figures, undrawn = _draw(comparison, aspects, shared, best, boundaries, folder, metadata)
    notes += undrawn
    overview = report.make_overview(runs, shared, best, boundaries, tables["changed_cells"])
    text = report.write_sections(shared, tables)
    return Findings(tables, overview, tuple(notes), text, tuple(figures))


def _identify(run: Candidate, index: int) -> dict[str, Any]:
    swept = {key: show(value) for key, value in run.values.items()}
    return {"index": index, "folder": run.name, "hash": run.hash, **swept}


def _with_values(rows: Sequence[tuple[dict[str, Any], dict[Any, Any]]]) -> pd.DataFrame:
    import pandas as pd

    return pd.DataFrame([{**identity, **row} for identity, row in rows]).drop(
        columns=["index", "hash"], errors="ignore"
    )


def _find_boundaries(
    runs: Sequence[Candidate], aspects: Sequence[Aspects], shared: Common
) -> tuple[pd.DataFrame, list[str]]:
    """The boundary of every run, with the run's `index`, and why some have none."""
    import pandas as pd

    from owtsweep.results.boundary import COLUMNS, find_boundary

    parts, notes = [], []
    for index, (run, told) in enumerate(zip(runs, aspects, strict=True)):
        if shared.boundary is None:
            break
        rows = shared.choose_rows(run.rows)
        try:
            table = find_boundary(
                rows, shared.conditions, shared.boundary, shared.criterion, told.window
            )
        except InputError as error:  # no such schemes, or amplitudes run one by one
            notes.append(f"{run.label}: no {'/'.join(shared.boundary)} boundary ({error})")
            continue
        parts.append(table.assign(index=index))
    empty = pd.DataFrame(columns=[*shared.names[:-1], *COLUMNS, "index"])
    return (pd.concat(parts, ignore_index=True) if parts else empty), notes


def _compare_pairs(
    comparison: Comparison,
    aspects: Sequence[Aspects],
    shared: Common,
    values: Sequence[pd.DataFrame],
    best: Sequence[pd.DataFrame],
) -> tuple[dict[str, pd.DataFrame], list[str]]:
    """The tables of pairs of runs, and notes on pairs that are not paired."""
    import pandas as pd

    from owtsweep.comparing import changes, shift

    runs = comparison.runs
    replicates = sorted({int(r) for table in values for r in table["replicate"].unique()})
    samples = [
        arrange_samples(table, shared, told.window, replicates)
        for table, told in zip(values, aspects, strict=True)
    ]
    winners = [changes.list_winners(table, shared.names) for table in best]
    changed: list[dict[str, Any]] = []
    schemes: list[dict[str, Any]] = []
    shifts: list[dict[str, Any]] = []
    unpaired: dict[str, None] = {}
    # an expectation stands where replicate 0 would, but it is no sample
    counts = {} if shared.samples else {"n_from": 0, "n_to": 0}
    for pair in comparison.pairs:
        a, b = pair.first, pair.second
        differing = find_unpaired(aspects[a], aspects[b])
        unpaired |= dict.fromkeys(differing)
        paired = not differing
        head = {
            "from_run": runs[a].label, "to_run": runs[b].label, "along": pair.along,
            "paired": paired,
        }  # fmt: skip
        criterion = {"criterion": shared.criterion}
        cells = changes.compare_cells(samples[a], samples[b], winners[a], winners[b], paired=paired)
        moved = changes.compare_schemes(samples[a], samples[b], paired=paired)
        changed += [head | criterion | row | counts for row in cells]
        schemes += [head | criterion | row | counts for row in moved]
        if shared.boundary is None:
            continue
        try:
            lines = shift.compare_boundaries(
                (shared.choose_rows(runs[a].rows), shared.choose_rows(runs[b].rows)),
                shared.conditions,
                shared.boundary,
                shared.criterion,
                (aspects[a].window, aspects[b].window),
                paired=paired,
            )
        except InputError:  # told with the boundaries
            lines = []
        shifts += [head | line for line in lines]
    notes = []
    if unpaired:
        notes.append(
            f"{', '.join(unpaired)} differs between runs: those pairs are not paired, their "
            "intervals are unpaired (Welch)"
        )
    pairs, names = changes.PAIR_COLUMNS, shared.names
    columns = {
        "boundary_shifts": [*pairs, *names[:-1], *shift.COLUMNS],
        "changed_cells": [*pairs, *names, *changes.CHANGED_COLUMNS],
        "scheme_changes": [*pairs, "scheme", *names, *changes.SCHEME_COLUMNS],
    }
    rows = (shifts, changed, schemes)
    tables = zip(columns.items(), rows, strict=True)
    return {name: pd.DataFrame(table, columns=order) for (name, order), table in tables}, notes


def _draw(
    comparison: Comparison,
    aspects: Sequence[Aspects],
    shared: Common,
    best: Sequence[pd.DataFrame],
    boundaries: pd.DataFrame,
    folder: Path,
    metadata: Mapping[str, str],
) -> tuple[list[Path], list[str]]:
    """The files drawn, and why others were not."""
    from owtsweep.comparing import boundary_figure, maps
    from owtsweep.comparing.panels import MOST_PANELS, arrange
    from owtsweep.figures import style
    from owtsweep.figures.plane import Plane

    panels = arrange(comparison)
    if panels is None:
        return [], [
            f"{len(comparison.runs)} runs that differ in {', '.join(comparison.keys)}: tables "
            f"only; figures show one or two keys and at most {MOST_PANELS} panels"
        ]
    windows = list(dict.fromkeys(told.window for told in aspects))
    described = " or ".join(style.describe_window(window) for window in windows)
    subtitle = f"by {shared.criterion} MSE, {described}"
    files, notes = [], []
    try:
        plane = Plane.over(shared.conditions, shared.grid)
    except InputError as error:
        notes.append(f"no maps ({error})")
    else:
        figure = maps.draw(panels, best, boundaries, shared, plane, subtitle=subtitle)
        files += style.save(figure, folder, "best_scheme_maps", metadata)
    if shared.boundary is None:
        return files, notes
    if not (boundaries["wins"] == "").any():
        notes.append(f"no run has an {'/'.join(shared.boundary)} boundary: see boundaries.csv")
        return files, notes
    figure = boundary_figure.draw(boundaries, comparison, shared, subtitle=subtitle)
    return files + style.save(figure, folder, "boundary", metadata), notes
