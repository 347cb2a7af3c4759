"""Keep the small files of what was made in results/reference, and say where both differ."""

import shutil
import tempfile
from pathlib import Path

from PIL import Image  # comes with matplotlib
from PIL.PngImagePlugin import PngInfo

from agreement import PROVENANCE, compare_folders, largest_difference

REFERENCE = Path("results/reference")
#: Pictures that get fewer colours than others, because they would be large: folder/name -> number.
COLOURS = {"plant/figure_03_record.png": 32}
#: What is kept of every run that has it.
TABLES = ("config.yaml", "manifest.json", "best_scheme.csv", "fidelity/fidelity.csv")
ALL = (
    *TABLES, "summary.csv", "figures/figure_*.png", "figures/error_spectra.png", "figures/*.csv",
    "figures/*.md", "fidelity/*.csv", "fidelity/*.md", "fidelity/figures/*.png",
)  # fmt: skip
#: Folder below results/ -> patterns of the files that are kept of it.
KEPT = {
    "readings": ("config.yaml", "manifest.json", "*.csv", "figures/*.png"),
    "default": (*TABLES, "figures/figure_18*.png"),
    "paper": ALL,
    "matched": ALL,
    "matched_on_paper": (*TABLES, "figures/figure_18*.png"),
    "rivals": ("config.yaml", "manifest.json", "*.csv"),
    "plant": ("*.csv", "*.png", "*.md"),
    "better": ("*.csv", "*.png"),
    "tower": (
        "summary_*.csv",
        "best_scheme_*.csv",
        "crossover.csv",
        "choices.csv",
        "checked.csv",
        "model_errors.csv",
        "declared_noise.csv",
        "wave_yaw.csv",
        "fidelity_claims.csv",
        "table_3.csv",
        "*.md",
        "*.png",
        "figures/*.png",
    ),
    "floater": (
        "summary_*.csv",
        "best_scheme_*.csv",
        "delay_margin.csv",
        "fidelity_claims.csv",
        "stored_tests.csv",
        "*.md",
        "*.png",
        "figures/*.png",
    ),
    "blade": (
        "summary_*.csv",
        "best_scheme_*.csv",
        "fidelity_claims.csv",
        "moving_hook.csv",
        "earth.csv",
        "*.md",
        "*.png",
    ),
    "mating": ("summary_*.csv", "best_scheme_*.csv", "*.png"),
    **dict.fromkeys(
        ("paper_all_inputs", "paper_same_variance"),
        (*TABLES, "summary.csv", "figures/figure_18*.png"),
    ),
}


class Keeper:
    """Compares folders below `results` with results/reference, and lists the files that differ.

    If `copies`, it also copies these to results/reference.
    """

    def __init__(self, results: Path, *, copies: bool) -> None:
        self.results, self.copies = results, copies
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

    def tell(self, name: str, differences: dict[str, str], largest: float) -> None:
        """Print whether a part agrees with results/reference, and remember the files that do not.

        `differences` and `largest` are the results of `compare_folders` and `largest_difference`.
        """
        if not differences:
            exact = "to the last digit" if largest == 0.0 else f"to {largest:.1e}"
            print(f"{name}: agrees with {REFERENCE / name}, numbers {exact}", flush=True)
        for file, text in differences.items():
            print(f"{name}: {file} {text}", flush=True)
        self.differing += [f"{name}/{file}" for file in differences]


def copy_small(source: Path, target: Path) -> None:
    """Copy a file into the one folder of a run in results/reference.

    A PNG is reduced to 192 colours, or those of `COLOURS`: a third of the size and alike to the
    eye. Links of a report to its pictures lead to the pictures beside it.
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
    colours = COLOURS.get(f"{source.parent.name}/{source.name}", 192)
    small = picture.convert("RGB").quantize(colours, dither=Image.Dither.NONE)
    small.save(target, optimize=True, pnginfo=notes)
