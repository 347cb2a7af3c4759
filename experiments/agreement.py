"""Compare files that were made again with those kept in results/reference."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from itertools import zip_longest
from pathlib import Path

import owtsweep
from owtsweep import InputError

#: Numbers agree if they differ by less than this, relative to themselves: other processors and
#: libraries round differently.
TOLERANCE = 1e-6
#: With `compare_numbers`: of a number relative to itself, of a difference or an end of an interval
#: relative to the larger error in its row. For runs of the same machine, before and after a change
#: that should move no number.
NEAR = 1e-9
#: A difference below this is rounding, of whatever.
ROUNDING = 1e-15
#: Columns with differences and intervals, in which digits are cancelled.
DIFFERENCES = ("difference", "ci_low", "ci_high", "value", "log2_ratio", "half_width", "relative")
#: Columns with the errors of a row that they come from.
ERRORS = (
    "mse_best", "mse_runner_up", "mean", "mse", "error_cut", "error_whole", "reproduced", "value",
    "threshold", "worst_deviation", "crossing", "nees", "bound_a", "bound_b",
)  # fmt: skip
#: Columns with names of winners. They may change if the gap `difference` is below `NEAR`.
WINNERS = ("best", "runner_up")
#: Columns of a run's rows that hold results; all others say which row it is.
RESULTS = ("motion", "cross", "noise", "value", "n_samples", "status", "reason")
#: Files that say when and where a run was made. While all other files agree, they are not replaced.
PROVENANCE = ("config.yaml", "manifest.json")


def compare_folders(made: Path, kept: Path) -> dict[str, str]:
    """Compare two folders: return the name of each file that differs, and how it differs.

    The result is empty if the folders agree. Configurations agree if they make equal runs, even if
    one has keys that the other lacks because they were added to the program later.
    """
    differences = _compare_files(made, kept, "*", _compare)
    if (made / "config.yaml").is_file():
        if not (kept / "config.yaml").is_file():
            differences["config.yaml"] = "is new"
        elif _identity(made) != _identity(kept):
            differences["config.yaml"] = "is another run's"
    return differences


def largest_difference(made: Path, kept: Path) -> float:
    """Return the largest relative difference of two numbers in the CSV tables of both folders."""
    tables = [path for path in made.glob("*.csv") if (kept / path.name).is_file()]
    return max((_numbers(path, kept / path.name)[0] for path in tables), default=0.0)


def compare_numbers(made: Path, kept: Path) -> dict[str, str]:
    """Compare the CSV tables of two folders: return how each table that differs does so, by name.

    For folders of the same machine, one made before a change that should move no number, and one
    after it. Times, texts and pictures are not compared. Numbers agree to `NEAR` of themselves;
    differences and ends of intervals agree to `NEAR` of the largest error in their row. Names of
    winners are equal unless the gap between the two is below that. On another machine some numbers
    differ by more (1e-2 in the tower's ill-conditioned claims); `compare_folders` tells how far.
    """
    return _compare_files(made, kept, "*.csv", _find_difference)


def _compare_files(
    made: Path, kept: Path, pattern: str, compare: Callable[[Path, Path], str]
) -> dict[str, str]:
    """Return how each file that differs does so; `compare` says how two files of a name differ."""
    differences = {}
    names = {path.name for folder in (made, kept) for path in folder.glob(pattern)}
    for name in sorted(names.difference(PROVENANCE)):
        if not (made / name).is_file():
            differences[name] = "was not made again"
        elif not (kept / name).is_file():
            differences[name] = "is new"
        elif text := compare(made / name, kept / name):
            differences[name] = text
    return differences


def compare_rows(made: Path, kept: Path) -> str:
    """Return how the stored rows of two run folders differ by more than `NEAR`; "" if they agree.

    A row is found again by what identifies it, whatever the order and the names of the files.
    Numbers are compared relative to the largest magnitude of their column with the same scheme and
    measure.
    """
    import pandas as pd

    tables = []
    for folder in (made, kept):
        parts = sorted((folder / "cases").glob("part-*.parquet"))
        if not parts:
            return f"has no rows in {folder}"
        table = pd.concat([pd.read_parquet(part) for part in parts], ignore_index=True)
        for name in table.columns.difference(table.select_dtypes("number").columns):
            table[name] = table[name].astype(object).where(table[name].notna(), "")
        axes = () if "motion" in table else ("noise",)  # of the tower's sensors
        keys = sorted(set(table) - set(RESULTS).difference(axes))
        tables.append(table.assign(turn=table.groupby(keys, dropna=False).cumcount()))
    if set(tables[0]) != set(tables[1]):
        return f"has other columns: {sorted(set(tables[0]) ^ set(tables[1]))}"
    both = tables[1].merge(
        tables[0], "outer", on=[*keys, "turn"], suffixes=("", " made"), indicator="side"
    )
    alone = (both["side"] != "both").sum()
    if alone:
        return f"has {alone} rows that are in one of both alone"
    scales = [name for name in ("scheme", "measure", "window") if name in both]
    for name in sorted(set(tables[1]) & set(RESULTS) - set(keys)):
        one, other = both[name], both[f"{name} made"]
        differs = (one != other) & (one.notna() | other.notna())
        if pd.api.types.is_float_dtype(one):
            size = one.abs().groupby([both[key] for key in scales], dropna=False).transform("max")
            differs &= ~((one - other).abs() <= NEAR * size)
        if differs.any():
            first = both[differs].iloc[0]
            return (
                f"differs in {differs.sum()} rows in the column {name}, "
                f"{first[f'{name} made']} instead of {first[name]}"
            )
    return ""


def _read(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def _find_difference(made_file: Path, kept_file: Path) -> str:
    """Return where two tables differ by more than `NEAR`; "" if they agree."""
    made, kept = _read(made_file), _read(kept_file)
    if len(made) != len(kept):
        return f"has {len(made)} lines instead of {len(kept)}"
    for line, (one, other) in enumerate(zip(made, kept, strict=True), 2):
        if one.keys() != other.keys():
            return f"has other columns: {', '.join(sorted(one.keys() ^ other.keys()))}"
        if other.get("claim", "").startswith("seconds"):
            continue
        size = max(_find_size(one), _find_size(other))
        gap = abs(_number(other.get("difference", "")))
        for name, a in one.items():
            b = other[name]
            if a == b or (name in WINNERS and gap <= NEAR * size):
                continue
            x, y = _number(a), _number(b)
            near = NEAR * (size if name in DIFFERENCES else max(abs(x), abs(y)))
            near = max(near, ROUNDING)
            if not abs(x - y) <= near:  # NaN, of a text, is never near
                return f"differs in line {line}, {name}: {a} instead of {b}"
    return ""


def _find_size(row: Mapping[str, str]) -> float:
    """Return the largest error in a row, or if it has none, its largest difference."""
    for names in (ERRORS, DIFFERENCES):
        sizes = [abs(_number(row[name])) for name in names if name in row]
        finite = [size for size in sizes if math.isfinite(size)]
        if finite:
            return max(finite)
    return 0.0


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


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
    one, other = _number(a), _number(b)
    if math.isnan(one) or math.isnan(other):  # a text, or NaN beside a number
        return math.inf
    return 0.0 if one == other else abs(one - other) / max(abs(one), abs(other))


def _pixels(path: Path) -> tuple[tuple[int, int], bytes]:
    from PIL import Image  # comes with matplotlib

    picture = Image.open(path).convert("RGB")
    return picture.size, picture.tobytes()


def _identity(folder: Path) -> object:
    try:
        run = owtsweep.load(folder)
    except InputError:  # of another version: its text says which run it is
        return (folder / "config.yaml").read_text("utf-8")
    return run.hash, run.config.grid, run.config.schemes
