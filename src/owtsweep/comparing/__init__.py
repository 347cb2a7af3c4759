"""Comparing runs of the hub study: maps, boundary, and what changes, with intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.comparing.cells import Common, best_of, common, samples_of, unpaired_keys, values_of
from owtsweep.errors import InputError
from owtsweep.sweep.comparison import Candidate, Comparison, Findings
from owtsweep.sweep.swept import show

if TYPE_CHECKING:
    import pandas as pd

#: The schemes whose boundary is told: below it the first is better, above it the second.
SCHEMES = ("HME2", "HME1")


def compare(comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]) -> Findings:
    """Tables, figures and words on how best scheme, boundary and errors move between runs.

    Raises
    ------
    InputError
        If the runs share no cell or scheme, or are judged by different criteria.
    """
    import pandas as pd

    from owtsweep.comparing import report

    shared = common(comparison)
    notes = list(shared.notes)
    runs = comparison.runs
    values = [values_of(run, shared) for run in runs]
    best = [best_of(run, own, shared) for own, run in zip(values, runs, strict=True)]
    boundaries, no_boundary = _boundaries(runs, shared)
    notes += no_boundary
    changed, schemes, shifts, unpaired = _pairs(comparison, shared, values, best)
    notes += unpaired
    identified = [_identify(run, i) for i, run in enumerate(runs)]
    tables = {
        "runs": pd.DataFrame(identified).drop(columns="index"),
        "best_schemes": _with_values(
            [(identified[i], row) for i, own in enumerate(best) for row in own.to_dict("records")]
        ),
        "boundaries": _with_values(
            [(identified[row["index"]], row) for row in boundaries.to_dict("records")]
        ),
        "boundary_shifts": shifts,
        "changed_cells": changed,
        "scheme_changes": schemes,
    }
    figures, undrawn = _draw(comparison, shared, best, boundaries, folder, metadata)
    notes += undrawn
    overview = report.overview(runs, shared, best, boundaries, changed)
    text = report.sections(comparison, shared, tables)
    return Findings(tables, overview, tuple(notes), text, tuple(figures))


def label(run: Candidate) -> str:
    """A run by its swept values."""
    return " ".join(f"{key}={show(value)}" for key, value in run.values.items())


def _identify(run: Candidate, index: int) -> dict[str, Any]:
    swept = {key: show(value) for key, value in run.values.items()}
    return {"index": index, "folder": run.name, "hash": run.hash, **swept}


def _with_values(rows: Sequence[tuple[dict[str, Any], dict[Any, Any]]]) -> pd.DataFrame:
    import pandas as pd

    return pd.DataFrame([{**own, **row} for own, row in rows]).drop(
        columns=["index", "hash"], errors="ignore"
    )


def _boundaries(runs: Sequence[Candidate], shared: Common) -> tuple[pd.DataFrame, list[str]]:
    import pandas as pd

    from owtsweep.results.boundary import COLUMNS, boundary

    parts, notes = [], []
    for index, run in enumerate(runs):
        rows = run.rows[run.rows["natural_period"].isin(shared.natural_periods)]
        try:
            found = boundary(rows, *SCHEMES, shared.criterion, run.config.measures.window)
        except InputError as error:  # no such schemes, or amplitudes run one by one
            notes.append(f"{label(run)}: no {'/'.join(SCHEMES)} boundary ({error})")
            continue
        parts.append(found.assign(index=index))
    empty = pd.DataFrame(columns=[*COLUMNS, "index"])
    return (pd.concat(parts, ignore_index=True) if parts else empty), notes


def _pairs(
    comparison: Comparison,
    shared: Common,
    values: Sequence[pd.DataFrame],
    best: Sequence[pd.DataFrame],
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame, list[str]]:
    """changed_cells, scheme_changes, boundary_shifts, and notes on pairs that are not paired."""
    import pandas as pd

    from owtsweep.comparing.changes import (
        CHANGED_COLUMNS,
        SCHEME_COLUMNS,
        changed_cells,
        scheme_changes,
        winners,
    )
    from owtsweep.comparing.shift import COLUMNS, boundary_shift

    runs = comparison.runs
    replicates = sorted({int(r) for own in values for r in own["replicate"].unique()})
    windows = [run.config.measures.window for run in runs]
    samples = [
        samples_of(own, shared, window, replicates)
        for own, window in zip(values, windows, strict=True)
    ]
    won = [winners(own) for own in best]
    judged = [run.rows[run.rows["natural_period"].isin(shared.natural_periods)] for run in runs]
    changed: list[dict[str, Any]] = []
    schemes: list[dict[str, Any]] = []
    shifts: list[dict[str, Any]] = []
    unpaired: dict[str, None] = {}
    for pair in comparison.pairs:
        a, b = pair.first, pair.second
        differing = unpaired_keys(runs[a].config, runs[b].config)
        unpaired |= dict.fromkeys(differing)
        paired = not differing
        head = {
            "from_run": label(runs[a]), "to_run": label(runs[b]), "along": pair.along,
            "paired": paired,
        }  # fmt: skip
        cells = changed_cells(samples[a], samples[b], won[a], won[b], paired=paired)
        criterion = {"criterion": shared.criterion}
        changes = scheme_changes(samples[a], samples[b], paired=paired)
        # an expectation stands where replicate 0 would, but it is no sample
        n = {"n_from": 0, "n_to": 0} if runs[a].config.engine == "expected" else {}
        changed += [head | criterion | row | n for row in cells]
        schemes += [head | criterion | row | n for row in changes]
        try:
            moved = boundary_shift(
                judged[a],
                judged[b],
                SCHEMES,
                shared.criterion,
                (windows[a], windows[b]),
                paired=paired,
            )
        except InputError:  # told with the boundaries
            moved = []
        shifts += [head | row for row in moved]
    notes = []
    if unpaired:
        notes.append(
            f"{', '.join(unpaired)} differs between runs: those pairs are not paired, their "
            "intervals are unpaired (Welch)"
        )
    return (
        pd.DataFrame(changed, columns=list(CHANGED_COLUMNS)),
        pd.DataFrame(schemes, columns=list(SCHEME_COLUMNS)),
        pd.DataFrame(shifts, columns=["from_run", "to_run", "along", "paired", *COLUMNS]),
        notes,
    )


def _draw(
    comparison: Comparison,
    shared: Common,
    best: Sequence[pd.DataFrame],
    boundaries: pd.DataFrame,
    folder: Path,
    metadata: Mapping[str, str],
) -> tuple[list[Path], list[str]]:
    from owtsweep.comparing import boundary_figure, maps
    from owtsweep.comparing.panels import MOST_PANELS, arrange
    from owtsweep.figures import style

    panels = arrange(comparison)
    if panels is None:
        return [], [
            f"{len(comparison.runs)} runs that differ in {', '.join(comparison.keys)}: tables "
            f"only; figures show one or two keys and at most {MOST_PANELS} panels"
        ]
    windows = list(dict.fromkeys(run.config.measures.window for run in comparison.runs))
    described = " or ".join(style.describe_window(window) for window in windows)
    subtitle = f"by {shared.criterion} MSE, {described}"
    figure = maps.draw(panels, best, boundaries, shared, subtitle=subtitle)
    files = style.save(figure, folder, "best_scheme_maps", metadata)
    if not (boundaries["wins"] == "").any():
        return files, [f"no run has an {'/'.join(SCHEMES)} boundary: see boundaries.csv"]
    figure = boundary_figure.draw(
        boundaries, comparison, amplitudes=shared.amplitudes, subtitle=subtitle
    )
    return files + style.save(figure, folder, "boundary", metadata), []
