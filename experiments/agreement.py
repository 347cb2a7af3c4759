"""Compare files that were made again with those kept in results/reference."""

from __future__ import annotations

import csv
from itertools import zip_longest
from pathlib import Path

import owtsweep
from owtsweep import InputError

#: Numbers agree if they differ by less than this, relative to themselves: other processors and
#: libraries round differently.
TOLERANCE = 1e-6
#: Files that say when and where a run was made. While all other files agree, they are not replaced.
PROVENANCE = ("config.yaml", "manifest.json")


def compare_folders(made: Path, kept: Path) -> dict[str, str]:
    """Compare two folders: return the name of each file that differs, and how it differs.

    The result is empty if the folders agree. Configurations agree if they make equal runs, even if
    one has keys that the other lacks because they were added to the program later.
    """
    differences = {}
    for name in sorted({path.name for folder in (made, kept) for path in folder.glob("*")}):
        if name in PROVENANCE:
            continue
        if not (made / name).is_file():
            differences[name] = "was not made again"
        elif not (kept / name).is_file():
            differences[name] = "is new"
        elif text := _compare(made / name, kept / name):
            differences[name] = text
    if (made / "config.yaml").is_file() and _identity(made) != _identity(kept):
        differences["config.yaml"] = "is another run's"
    return differences


def largest_difference(made: Path, kept: Path) -> float:
    """Return the largest relative difference of two numbers in the CSV tables of both folders."""
    tables = [path for path in made.glob("*.csv") if (kept / path.name).is_file()]
    return max((_numbers(path, kept / path.name)[0] for path in tables), default=0.0)


def _compare(made: Path, kept: Path) -> str:
    if made.read_bytes() == kept.read_bytes():
        return ""
    if made.suffix == ".png":
        return "" if _pixels(made) == _pixels(kept) else "shows another picture"
    if made.suffix != ".csv":
        return "has another text"
    difference, place = _numbers(made, kept)
    return f"differs by {difference:.1e} in {place}" if difference > TOLERANCE else ""


def _numbers(made: Path, kept: Path) -> tuple[float, str]:
    """Return the largest relative difference of two CSV tables, and where it is.

    The difference is infinite if two texts differ, or if a number stands where there is none in the
    other table.
    """
    largest, where = 0.0, ""
    with made.open(newline="") as first, kept.open(newline="") as second:
        rows = zip_longest(csv.reader(first), csv.reader(second), fillvalue=[])
        for line, (one, other) in enumerate(rows, 1):
            for a, b in zip_longest(one, other, fillvalue="nothing"):
                difference = 0.0 if a == b else _relative(a, b)
                if difference > largest:
                    largest, where = difference, f"line {line}: {a} instead of {b}"
    return largest, where


def _relative(a: str, b: str) -> float:
    try:
        one, other = float(a), float(b)
    except ValueError:
        return float("inf")
    difference = abs(one - other) / max(abs(one), abs(other))
    return difference if difference == difference else float("inf")  # NaN beside a number


def _pixels(path: Path) -> tuple[tuple[int, int], bytes]:
    from PIL import Image  # comes with matplotlib

    picture = Image.open(path).convert("RGB")
    return picture.size, picture.tobytes()


def _identity(folder: Path) -> object:
    try:
        run = owtsweep.load(folder)
    except InputError:
        return None
    return run.hash, run.config.grid, run.config.schemes
