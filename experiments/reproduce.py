"""Everything behind docs/reproduction.md: the search, both runs, all figures, the report.

    python experiments/reproduce.py [REPLICATES]

Runs what is missing below results/ (100 records per cell by default), draws and reports, and copies
the small outputs to results/reference/. `make reproduce` calls it.
"""

import shutil
import sys
from pathlib import Path

import owtsweep
from owtsweep.cli import main

REPLICATES = int(sys.argv[1]) if len(sys.argv) > 1 else 100
REFERENCE = Path("results/reference")
KEPT = (
    "config.yaml", "manifest.json", "summary.csv", "best_scheme.csv", "trials.csv", "best.csv",
    "figures/*.png", "figures/*.csv", "figures/*.md", "fidelity/*.csv", "fidelity/*.md",
)  # fmt: skip


def step(*words: str) -> None:
    """Run one command of the program, or stop with its exit code."""
    print("$ python -m owtsweep", *words, flush=True)
    code = main(list(words))
    if code:
        sys.exit(code)


def keep(run: Path, name: str) -> None:
    """Copy a run's small outputs to results/reference/<name>."""
    target = REFERENCE / name
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    for pattern in KEPT:
        for file in sorted(run.glob(pattern)):
            shutil.copy(file, target / file.name)


step("sweep", "experiment=readings", "name=readings")
step("figures", "results/readings")
keep(Path("results/readings"), "readings")
for tuning in ("paper", "matched"):
    step("sweep", f"tuning={tuning}", f"name={tuning}", f"grid.replicates={REPLICATES}")
    step("figures", f"results/{tuning}")
    step("fidelity", f"results/{tuning}")
    keep(Path(f"results/{tuning}"), tuning)

from owtsweep.studies.hub.figures import two_maps  # noqa: E402  (heavy, and only needed now)

paper, matched = (owtsweep.load(f"results/{tuning}") for tuning in ("paper", "matched"))
for file in two_maps.save(paper, matched, REFERENCE / "two_maps"):
    print(file)
