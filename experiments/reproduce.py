"""Everything behind docs/reproduction.md: the search, the runs, all figures, the reports.

    python experiments/reproduce.py [REPLICATES]

Runs what is missing below results/ (100 records per cell by default), draws and reports, and copies
the small outputs to results/reference/. `make reproduce` calls it.
"""

import shutil
import sys
from pathlib import Path

from PIL import Image  # comes with matplotlib
from PIL.PngImagePlugin import PngInfo

import owtsweep
from owtsweep.cli import main
from owtsweep.figures import style
from owtsweep.studies.hub.figures import two_maps

REPLICATES = sys.argv[1] if len(sys.argv) > 1 else "100"
REFERENCE = Path("results/reference")
#: Run -> its overrides. `matched_on_paper` has the truth of `paper`: only the tuning differs.
RUNS = {
    "default": ["grid.replicates=20"],
    "paper": ["experiment=paper", "tuning=paper"],
    "matched": ["tuning=matched"],
    "matched_on_paper": ["experiment=paper", "tuning=matched"],
}
#: The paper's reading with one thing changed, HME1 against HME2: what makes the map what it is.
ABLATIONS = {
    "paper_all_inputs": ["hme.mhe.inputs=all"],
    "paper_same_variance": ["hme1.r_gnss.scale=0.303"],
}
TABLES = ("config.yaml", "manifest.json", "best_scheme.csv", "fidelity/fidelity.csv")
ALL = (
    *TABLES, "summary.csv", "figures/figure_*.png", "figures/error_spectra.png", "figures/*.csv",
    "figures/*.md", "fidelity/*.csv", "fidelity/*.md",
)  # fmt: skip
KEPT = {
    "readings": ("config.yaml", "manifest.json", "*.csv", "figures/*.png"),
    "default": (*TABLES, "figures/figure_18*.png"),
    "paper": ALL,
    "matched": ALL,
    "matched_on_paper": (*TABLES, "figures/figure_18*.png"),
    **dict.fromkeys(ABLATIONS, (*TABLES, "summary.csv", "figures/figure_18*.png")),
}


def step(*words: str) -> None:
    """Run one command of the program, or stop with its exit code."""
    print("$ python -m owtsweep", *words, flush=True)
    code = main(list(words))
    if code:
        sys.exit(code)


def keep(run: Path, name: str) -> None:
    """Copy a run's small outputs to results/reference/<name>, pictures with fewer colours."""
    target = REFERENCE / name
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    for pattern in KEPT[name]:
        for file in sorted(run.glob(pattern)):
            if file.suffix == ".png":
                shrink(file, target / file.name)
            else:
                shutil.copy(file, target / file.name)


def shrink(source: Path, target: Path) -> None:
    """Write a PNG with a palette and its metadata: a third of the size, the same to the eye."""
    picture = Image.open(source)
    notes = PngInfo()
    for key, value in picture.info.items():
        if isinstance(value, str):
            notes.add_text(key, value)
    small = picture.convert("RGB").quantize(192, dither=Image.Dither.NONE)
    small.save(target, optimize=True, pnginfo=notes)


step("sweep", "experiment=readings", "name=readings")
keep(Path("results/readings"), "readings")
for name, overrides in RUNS.items():
    step("sweep", f"grid.replicates={REPLICATES}", *overrides, f"name={name}")
    step("figures", f"results/{name}")
    step("fidelity", f"results/{name}")
    keep(Path(f"results/{name}"), name)
for name, overrides in ABLATIONS.items():
    words = ["experiment=paper", "schemes=[HME1,HME2]", f"grid.replicates={REPLICATES}"]
    step("sweep", *words, *overrides, f"name={name}")
    keep(Path(f"results/{name}"), name)
paper, matched = (owtsweep.load(f"results/{name}") for name in ("paper", "matched_on_paper"))
figure = two_maps.draw(paper, matched)
metadata = {"paper": paper.hash, "matched": matched.hash}
png, _ = style.save(figure, Path("results"), "two_maps", metadata)
shrink(png, REFERENCE / "two_maps.png")
