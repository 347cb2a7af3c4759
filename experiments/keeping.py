"""Keep the small files of what was made in results/reference, and say where both differ."""

import shutil
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image  # comes with matplotlib
from PIL.PngImagePlugin import PngInfo

from experiments.agreement import (
    NEAR,
    PROVENANCE,
    compare_folders,
    compare_numbers,
    compare_rows,
    largest_difference,
)
from experiments.command import read_data

REFERENCE = Path("results/reference")
#: Colours of a kept picture, and how many of them at most are taken from its flat areas.
COLOURS, FLAT_COLOURS = 256, 192
#: A colour is that of a flat area if it fills this many squares of 2 x 2 pixels.
LEAST_SQUARES = 20
#: The parts of reproduce.toml; each names the files that are kept of it.
PARTS = read_data(str(Path(__file__).with_name("reproduce")))
KEPT = {name: part["keep"] for name, part in PARTS.items() if "keep" in part}


class Keeper:
    """Compares folders below `results` with results/reference, and lists the files that differ.

    If `copies`, it also copies these to results/reference.
    """

    def __init__(self, results: Path, *, copies: bool) -> None:
        self.results, self.copies, self.reference = results, copies, REFERENCE
        self.differing: list[str] = []

    def keep(self, name: str) -> None:
        """Compare a run's small outputs with results/reference/<name>; copy them if they differ."""
        with tempfile.TemporaryDirectory() as folder:
            made, kept = Path(folder), REFERENCE / name
            for pattern in KEPT[name]:
                for file in sorted((self.results / name).glob(pattern)):
                    copy_small(file, made / file.name)
            differences = compare_folders(made, kept)
            self.tell(name, differences, largest_difference(made, kept))
            if differences and self.copies:
                kept.mkdir(parents=True, exist_ok=True)
                for file in differences:
                    (kept / file).unlink(missing_ok=True)
                for file in {*differences, *PROVENANCE}:
                    if (made / file).is_file():
                        shutil.copy(made / file, kept / file)

    def keep_file(self, file: Path, reference: Path = REFERENCE) -> None:
        """Compare one picture or table with the kept one in `reference`; copy it if it differs."""
        with tempfile.TemporaryDirectory() as folder:
            made, kept = Path(folder) / "made", Path(folder) / "kept"
            for target in (made, kept):
                target.mkdir()
            copy_small(file, made / file.name)
            if (reference / file.name).is_file():
                shutil.copy(reference / file.name, kept)
            differences = compare_folders(made, kept)
            self.tell(file.name, differences, largest_difference(made, kept))
            if differences and self.copies:
                shutil.copy(made / file.name, reference / file.name)

    def keep_rows(self, name: str) -> None:
        """Do nothing: results/reference holds no rows. `NumbersKeeper` compares them."""

    def tell(self, name: str, differences: dict[str, str], largest: float) -> None:
        """Print whether a part agrees with results/reference, and remember the files that do not.

        `differences` and `largest` are the results of `compare_folders` and `largest_difference`.
        """
        if not differences:
            exact = "to the last digit" if largest == 0.0 else f"to {largest:.1e}"
            print(f"{name}: agrees with {self.reference / name}, numbers {exact}", flush=True)
        for file, text in differences.items():
            print(f"{name}: {file} {text}", flush=True)
        self.differing += [f"{name}/{file}" for file in differences]


class NumbersKeeper(Keeper):
    """Compares the numbers of tables and rows with those in `reference`, and copies nothing.

    `reference` is laid out as results/reference, or is a folder of results as `make reproduce`
    leaves it; only the latter holds the rows of runs.
    """

    def __init__(self, results: Path, reference: Path) -> None:
        super().__init__(results, copies=False)
        self.reference = reference

    def keep(self, name: str) -> None:
        """Compare the tables of a part that are kept in results/reference."""
        self._compare(
            name, find_tables(self.results / name, name), find_tables(self.reference / name, name)
        )

    def keep_file(self, file: Path, reference: Path | None = None) -> None:
        """Compare one table; a picture is not compared."""
        if file.suffix == ".csv":
            other = (reference or self.reference) / file.name
            self._compare(file.name, {file.name: file}, {file.name: other})

    def keep_rows(self, name: str) -> None:
        """Compare the rows of a run, if `reference` has them."""
        if (self.reference / name / "cases").is_dir():
            text = compare_rows(self.results / name, self.reference / name)
            self.tell(f"rows of {name}", {"cases": text} if text else {}, NEAR)

    def _compare(self, name: str, made: dict[str, Path], kept: dict[str, Path]) -> None:
        with tempfile.TemporaryDirectory() as scratch:
            folders = [Path(scratch) / part for part in ("made", "kept")]
            for folder, files in zip(folders, (made, kept), strict=True):
                folder.mkdir()
                for target, file in files.items():
                    if file.is_file():
                        shutil.copy(file, folder / target)
            self.tell(name, compare_numbers(*folders), NEAR)


def find_tables(folder: Path, name: str) -> dict[str, Path]:
    """Return name -> file of the tables that are kept of a part, in a run or all in one folder."""
    patterns = [pattern for pattern in KEPT[name] if pattern.endswith(".csv")]
    places = [place for pattern in patterns for place in (Path(pattern).name, pattern)]
    return {file.name: file for place in places for file in folder.glob(place)}


def copy_small(source: Path, target: Path) -> None:
    """Copy a file into the one folder of a run in results/reference.

    A PNG is reduced to `COLOURS` colours: a third of the size (`reduce_colours`). Links of a report
    to its pictures lead to the pictures beside it.
    """
    if source.suffix == ".md":
        target.write_text(source.read_text("utf-8").replace("](figures/", "]("), "utf-8")
        return
    if source.suffix != ".png":
        shutil.copy(source, target)
        return
    picture = Image.open(source)
    notes = PngInfo()
    for key, value in picture.info.items():
        if isinstance(value, str):
            notes.add_text(key, value)
    reduce_colours(picture).save(target, optimize=True, pnginfo=notes)


def reduce_colours(picture: Image.Image) -> Image.Image:
    """Return a picture with at most `COLOURS` colours, in which flat areas keep theirs exactly.

    Flat are cells, swatches of a legend, background and thick lines. The other colours are blends
    at the edges of letters and lines: each becomes the nearest of those that are kept. One after
    another is kept that is farthest from all kept before, where more pixels make a colour count
    more, so that none is far off. (Median cut makes one grey of the rare colours of a legend.)
    """
    pixels = np.asarray(picture.convert("RGB"), dtype=np.uint32)
    codes, flat_index = np.unique(pixels @ [65536, 256, 1], return_inverse=True)
    index = flat_index.reshape(pixels.shape[:2])
    corner = index[:-1, :-1]
    squares = (corner == index[1:, :-1]) & (corner == index[:-1, 1:]) & (corner == index[1:, 1:])
    filled = np.bincount(corner[squares], minlength=len(codes))
    commonest = np.argsort(-filled, kind="stable")[:FLAT_COLOURS]
    kept = [int(colour) for colour in commonest if filled[colour] >= LEAST_SQUARES]
    colours = np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=1).astype(float)
    weights = np.sqrt(np.bincount(index.ravel()))
    nearest = np.zeros(len(codes), dtype=np.uint8)
    distances = np.full(len(codes), np.inf)  # squared, to the nearest kept colour
    for number in range(min(COLOURS, len(codes))):
        if number == len(kept):
            kept.append(int(np.argmax(distances * weights)))
        to_this = ((colours - colours[kept[number]]) ** 2).sum(axis=1)
        nearest[to_this < distances] = number
        distances = np.minimum(distances, to_this)
    small = Image.fromarray(nearest[index])
    small.putpalette(colours[kept].astype(np.uint8).tobytes())
    return small
