"""Compares runs: opens the runs, finds the keys in which they differ, and writes the comparison.

The comparison itself is the work of the study to which the runs belong.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from owtsweep.comparing.comparison import (
    RUN,
    Candidate,
    Comparison,
    Findings,
    make_pairs,
    rank_values,
    show,
    swept_keys,
)
from owtsweep.config import as_mapping, require
from owtsweep.config.typed import value_at
from owtsweep.errors import InputError, printable
from owtsweep.io import markdown
from owtsweep.io.files import check_writable, write_atomically
from owtsweep.io.reading import refuse_links, require_folder
from owtsweep.io.tables import write_table
from owtsweep.report.several_page import make_comparison_page
from owtsweep.sweep.asked import PAGE
from owtsweep.sweep.keys import hash_text
from owtsweep.sweep.multirun import read_record
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import FAILED, OK, UNABLE, blame


@dataclass(frozen=True)
class Compared:
    """A finished comparison.

    folder: the folder that the comparison was written to.
    findings: What the study has found: its tables and its text.
    overview: the table that the terminal shows: one row per run.
    notes: Lines on runs that are left out or incomplete, and the notes of the study.
    """

    folder: Path
    findings: Findings
    overview: pd.DataFrame
    notes: tuple[str, ...]


def compare(paths: Sequence[str], load: Callable[[Path], Run]) -> Compared:
    """Compare the runs of a multirun, or any runs of one study, and write the comparison.

    paths: one multirun folder, or several folders, each of a run or of a multirun.
    load: a function that opens the run in a folder (`owtsweep.load`).
    Returns: the comparison. It is written to `<path>/comparison` if one path is given, and
        otherwise to `comparison-<hash>` beside the first run.
    Raises InputError if fewer than two runs have a succeeded case, a run is named twice, the runs
        belong to different studies or have nothing in common, their study cannot compare runs, or
        the folder cannot be written. Nothing has been written then. Also if the study is of another
        package and does not work; its figures may have been written then.
    """
    runs, preferred, notes = _open(paths, load)
    studies = list(dict.fromkeys(run.config.study for run in runs))
    require(
        len(studies) < 2, f"compare: these are runs of several studies, {', '.join(studies)}; "
        "compare runs of one study",
    )  # fmt: skip
    loaded = _with_results(runs, notes)
    notes = list(dict.fromkeys(notes))
    if len(loaded) < 2:
        number = "no run" if not loaded else "only one run"
        why = f" ({notes[0]})" if notes else ""
        raise InputError(f"{paths[0]}: {number} has a succeeded case{why}; compare needs two runs")
    study = loaded[0][0].study
    if "compare" not in study.commands:
        raise InputError(f"compare: the study {study.name!r} has no comparison of its runs")
    comparison = _arrange(loaded, preferred)
    hashes = " ".join(candidate.hash for candidate in comparison.runs)
    folder = _folder(paths, [run for run, _ in loaded])
    refuse_links(folder)
    check_writable(folder, "compare", "move away what is there, or get the right to write")
    swept = pd.DataFrame([run.shown for run in comparison.runs], columns=list(comparison.keys))
    metadata = {"runs": hashes, "folder": folder.name}
    with blame(study):  # also if it returns something else than findings
        findings = study.compare(comparison, folder, metadata=metadata)
        every_note = tuple(map(printable, (*notes, *findings.notes)))
        overview = pd.concat([swept, findings.overview.reset_index(drop=True)], axis=1)
        overview = overview.rename(columns=printable).map(printable)
        report = _report(comparison, findings, overview, every_note)
        # a file without columns could not be read back
        tables = {name: table for name, table in findings.tables.items() if len(table.columns)}
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in tables.items():
        write_table(folder, name, table)
    write_atomically(folder / "comparison.md", report)
    pictures = {path.stem: path for path in findings.figures if path.suffix == ".png"}
    page = make_comparison_page(
        f"Comparison of {len(comparison.runs)} runs of the study {study.name}",
        findings.origin,
        overview,
        every_note,
        {name.replace("_", " "): path.read_bytes() for name, path in pictures.items()},
        findings.tables,
    )
    write_atomically(folder / PAGE, page)
    return Compared(folder, findings, overview, every_note)


def _open(
    paths: Sequence[str], load: Callable[[Path], Run]
) -> tuple[list[Run], list[str], list[str]]:
    """Open the runs and multiruns at `paths`.

    Return the runs, the keys that the multiruns swept, and notes on runs that are left out. A run
    of a multirun that cannot be opened is left out.

    Raises InputError if a path holds no run, a run is named twice, or a run that `paths` names
        directly (not through a multirun) cannot be opened.
    """
    runs: list[Run] = []
    preferred: list[str] = []
    notes: list[str] = []
    seen: set[Path] = set()
    for path in map(Path, paths):
        require_folder(path)
        multirun = not os.path.lexists(path / "config.yaml")
        if multirun:
            refuse_links(path, deep=False)
        folders, swept = _members(path, notes) if multirun else ([path], [])
        require(bool(folders), f"{path}: there is no run in it; name a multirun or several runs")
        preferred += swept
        for folder in folders:
            if folder.resolve() in seen:
                raise InputError(f"{folder}: this run is named twice; name each run once")
            seen.add(folder.resolve())
            try:
                runs.append(load(folder))
            except InputError as error:
                if not multirun:
                    raise
                notes.append(f"{folder.name} is left out: {error}")
    return runs, list(dict.fromkeys(preferred)), notes


def _members(path: Path, notes: list[str]) -> tuple[list[Path], list[str]]:
    """Return the run folders of the multirun at `path`, and the keys that the multirun swept.

    The folders are in the multirun's order. Without a multirun.json, the order is alphabetical and
    there are no keys. A note on each run that was never started is added to `notes`.
    """
    folders = sorted(config.parent for config in path.glob("*/config.yaml"))
    names, keys = read_record(path)
    there = {folder.name: folder for folder in folders}
    notes += [f"{name} is left out: it was never started" for name in names if name not in there]
    ordered = [there.pop(name) for name in names if name in there]
    return [*ordered, *there.values()], keys


def _with_results(runs: Sequence[Run], notes: list[str]) -> list[tuple[Run, pd.DataFrame]]:
    loaded = []
    for run in [part for whole in runs for part in whole.by_tuning().values()]:
        stored, missing = run.stored()
        rows = next(iter(stored.values()), None)
        if rows is None or not (rows["status"] == OK).any():
            notes.append(f"{run.folder.name} is left out: no case of it has succeeded")
            continue
        failed, unable = (int((rows["status"] == status).sum()) for status in (FAILED, UNABLE))
        if run.config.records is not None and run.config.records.decides:
            notes.append(
                f"{run.folder.name}: its cells got records until they were decided; a cell is "
                "compared over the records that all its schemes have"
            )
        if missing:
            notes.append(f"{run.folder.name} is incomplete: {missing} of its blocks are missing")
        if failed:
            notes.append(f"{run.folder.name}: {failed} of its {len(rows)} rows failed")
        if unable:
            notes.append(f"{run.folder.name}: no number in {unable} of its {len(rows)} rows")
        loaded.append((run, rows))
    return loaded


def _arrange(loaded: Sequence[tuple[Run, pd.DataFrame]], preferred: Sequence[str]) -> Comparison:
    mappings = [as_mapping(run.config) for run, _ in loaded]
    keys, following = swept_keys(mappings, preferred)
    values: list[dict[str, object]] = [{k: value_at(m, k) for k in keys} for m in mappings]
    shown = {tuple(show(value) for value in of_run.values()) for of_run in values}
    if len(shown) < len(values):  # e.g. the runs differ in their grids or schemes
        names = [run.folder.name for run, _ in loaded]
        unique = len(set(names)) == len(names)
        for of_run, (run, _) in zip(values, loaded, strict=True):
            of_run[RUN] = printable(run.folder.name if unique else str(run.folder))
        keys = [*keys, RUN]
    places = list(
        zip(*(rank_values([of_run[key] for of_run in values]) for key in keys), strict=True)
    )
    order = sorted(range(len(loaded)), key=lambda i: places[i])
    runs = tuple(
        Candidate(printable(run.folder.name), run.hash, run.config, rows, values[i])
        for i in order
        for run, rows in [loaded[i]]
    )
    pairs = make_pairs([places[i] for i in order], keys)
    return Comparison(tuple(keys), tuple(following), runs, tuple(pairs))


def _folder(paths: Sequence[str], runs: Sequence[Run]) -> Path:
    if len(paths) == 1:
        return Path(paths[0]) / "comparison"
    identity = "\n".join(sorted(f"{run.folder.name} {run.hash}" for run in runs))
    return runs[0].folder.parent / f"comparison-{hash_text(identity)}"


def _report(
    comparison: Comparison, findings: Findings, overview: pd.DataFrame, notes: Sequence[str]
) -> str:
    rows = zip(overview.itertuples(index=False), comparison.runs, strict=True)
    table = markdown.table(
        [*overview.columns, "run folder"], [[*row, run.name] for row, run in rows]
    )
    head = [f"# Comparison of {len(comparison.runs)} runs"]
    if findings.origin:
        head.append(markdown.escape(printable(findings.origin)))
    parts = [*head, table]
    if comparison.following:
        keys = ", ".join(f"`{key}`" for key in comparison.following)
        parts.append(f"Changing along with these keys: {keys}.")
    if notes:
        parts.append("Notes:\n\n" + "\n".join(f"- {markdown.escape(note)}" for note in notes))
    return "\n\n".join([*parts, findings.report]).rstrip() + "\n"
