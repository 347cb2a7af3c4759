"""The command `runs`: a line on each run in a folder. Nothing that a run names is executed."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from owtsweep.cli import DONE
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError, printable, shorten
from owtsweep.io.reading import expand_home, read_json, require_folder
from owtsweep.io.tables import read_map
from owtsweep.sweep.manifest import read_manifest
from owtsweep.sweep.plan import MOST_BYTES, PLAN_FILE, read_blocks

#: Folders of runs may lie in folders of multiruns, and those in the folder that is listed.
DEEPEST = 3
#: Folders that a run has; no run lies in them.
OWN = {"asked", "cases", "figures", "fidelity", "records", "estimates"}
#: Most characters of a cell.
LONGEST_CELL = 60


class _Line(NamedTuple):
    """A run in words; the fields are the headings of the columns."""

    folder: str
    study: str = "-"
    experiment_or_name: str = "-"
    tuning: str = "-"
    cells_decided: str = "-"
    date: str = "-"
    state: str = "-"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print a line on each run in the folder `options.folder`, and return 0.

    A folder whose configuration cannot be read, or that holds no run, has a line that says so.
    `argv` is not used.

    Raises InputError if there is no such folder.
    """
    folder = expand_home(options.folder)
    require_folder(folder)
    lines = [*_list_lines(folder)]
    if not lines:
        print(f"{printable(str(folder))}: it holds no run")
        return DONE
    cells = [[shorten(printable(cell), LONGEST_CELL) for cell in line] for line in lines]
    cells.insert(0, [name.replace("_", " ") for name in _Line._fields])
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for line in cells:
        padded = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        print("  ".join(padded).rstrip())
    return DONE


def _list_lines(home: Path) -> Iterator[_Line]:
    """Yield a line for each run below a folder, and for each folder in it without any."""
    for path in [home] if (home / "config.yaml").is_file() else _list_folders(home):
        found = [*_find_runs(path, DEEPEST - 1)]
        yield from (_describe(each, str(each.relative_to(home))) for each in found)
        if not found:
            yield _Line(path.name, state=_describe_other(path))


def _list_folders(folder: Path) -> list[Path]:
    try:
        inside = sorted(folder.iterdir())
    except OSError:  # it may not be read
        return []
    return [path for path in inside if path.is_dir() and not path.is_symlink()]


def _find_runs(folder: Path, depth: int) -> Iterator[Path]:
    if os.path.lexists(folder / "config.yaml"):
        yield folder
        return
    for path in _list_folders(folder) if depth > 0 else []:
        if path.name not in OWN:
            yield from _find_runs(path, depth - 1)


def _describe_other(folder: Path) -> str:
    """Return what a folder without a run is, as far as its name and files tell."""
    command = folder.name.partition("-")[0]
    if command in ("vary", "spectrum", "place") and any(folder.glob("*.csv")):
        return f"an answer of `{command}`"
    return "no run"


def _describe(folder: Path, name: str) -> _Line:
    """Return the line on a run, which may be another person's; its values are taken as texts."""
    config: Mapping[str, object] = {}
    manifest: Mapping[str, object] = {}
    decided = "-"  # how many cells of the map are won or tied, of how many
    try:
        config, _ = read_stored(folder / "config.yaml")
        if (cells := read_map(folder)) is not None:
            decided = f"{int((cells['verdict'] != 'open').sum())} of {len(cells)}"
        manifest = read_manifest(folder)
        state = _describe_state(folder, str(manifest.get("state")))
    except InputError as error:
        reason = str(error).removeprefix(f"{folder}/").removeprefix(f"{folder}: ")
        state = f"damaged: {reason}"
    given = config.get("name") or config.get("experiment")
    tuning = config.get("tuning")
    return _Line(
        name,
        str(config.get("study", "-")),
        str(given or "-"),
        ", ".join(map(str, tuning)) if isinstance(tuning, list) else str(tuning or "-"),
        decided,
        str(manifest.get("started", "-"))[:10],
        state,
    )


def _describe_state(folder: Path, state: str) -> str:
    """Return whether a run is finished, or how many of its cases are missing.

    Raises InputError if plan.json cannot be read.
    """
    if not os.path.lexists(folder / PLAN_FILE) or not (folder / "cases").is_dir():
        return "a copy without its cases"
    path = folder / PLAN_FILE
    there = {shard.name for shard in (folder / "cases").glob("part-*.parquet")}
    cases = missing = 0
    for block, key, _ in read_blocks(path, read_json(path, MOST_BYTES)):
        cases += block.cases
        missing += block.cases * (f"part-{key}.parquet" not in there)
    if missing:
        running = ", running or killed" if state == "running" else ""
        return f"{missing} of {cases} cases missing{running}"
    return "finished" if state == "done" else f"all cases there, but {state}"
