"""Make everything behind the reports and pictures of docs/: searches, runs, figures.

    python -m experiments.reproduce [REPLICATES] [--check[=numbers]] [--against FOLDER]

The script runs what is missing below results/ (100 records per cell by default), draws the figures
and writes the reports. Then it compares the small outputs with results/reference/, says how far
they agree, and copies those that differ to results/reference/. With --check everything is computed
anew in a temporary folder, nothing is copied, and the exit code is 1 if something differs. `make
reproduce` calls this script.

--check=numbers is for a change of the program that should move no number, on one machine: make all
before the change, then compare after it. It compares rows and tables to 1e-9, and differences and
intervals to 1e-9 of the larger error in their row; names of winners must be equal unless the gap is
below that (`agreement.compare_numbers`). It looks at no times, texts and pictures. --against names
what was made before, which is results/reference by default; a whole folder of results, as a run of
this script without --check leaves it, also has the rows. On another machine the numbers of
results/reference differ by up to 1e-2: use --check there, and judge.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import owtsweep
from experiments.keeping import REFERENCE, Keeper, NumbersKeeper
from experiments.ren2019 import plant, two_maps
from owtsweep.cli import main
from owtsweep.io.tables import write_table
from owtsweep.studies.blade import measures as blade_measures
from owtsweep.studies.floater import measures as floater_measures
from owtsweep.studies.hub.figures.listing import TIME_HISTORIES
from owtsweep.studies.registry import get_study
from owtsweep.studies.tower.measures import CRITERIA

#: Run -> its overrides. `matched_on_paper` has the truth of `paper`: only the tuning differs.
RUNS = {
    "default": ["experiment=study", "tuning=paper", "grid.replicates=20"],
    "paper": ["experiment=paper", "tuning=paper"],
    "matched": ["experiment=study", "tuning=matched"],
    "matched_on_paper": ["experiment=paper", "tuning=matched"],
}
#: The paper's reading with one thing changed, for HME1 and HME2: shows what shapes the map.
ABLATIONS = {
    "paper_all_inputs": ["hme.mhe.inputs=all"],
    "paper_same_variance": ["hme1.r_gnss.scale=0.303"],
}
#: The runs behind docs/plant.md: the map under the envelope, and the seas of figures 3-4 and 9-14.
PLANT = {
    "both_tunings": ["experiment=paper", "tuning=[paper,matched]"],
    "plant_seas": [
        "motion=plant", "motion.hs=[2]", "motion.tp=[6,8]", "tuning=[paper,matched]",
        "grid.replicates=20",
    ],
}  # fmt: skip
#: What the paper's printed numbers stand in, beside those of a run.
PAPER_FIGURES = ("figure_15", "figure_16", "figure_17", "tables_6_to_9")
#: Maps of the floater study.
PLANES = ("delay_bias", "snr_loss", "believed_snr", "roll_snr")
#: The blade's schemes but two, which agree with MEKF within 1 % and run with one unit only.
_OTHERS = [name for name in get_study("blade").schemes() if name not in ("UKF", "INVARIANT_EKF")]
BLADE_OTHERS = f"schemes=[{','.join(_OTHERS)}]"
#: Sweeps of the blade study -> overrides.
BLADE = {
    "sigma_outage_tactical": ("unit=tactical",),
    "sigma_outage_fog": ("unit=fog", BLADE_OTHERS),
    "sigma_outage_mems": ("unit=mems", BLADE_OTHERS),
    "offset_sigma": (
        "plane=offset_sigma",
        "schemes=[HOLD,GNSS_WAHBA,COMPLEMENTARY,MEKF,MEKF_HEADING,MEKF_OFFSET,PENDULUM]",
    ),
}
#: Records per cell of these sweeps: a map of the usual 4 tells too few schemes apart. Records that
#: are judged.
BLADE_RECORDS, BLADE_JUDGED = 10, 40
#: Sweeps of the mating study -> overrides.
MATING = {
    "sigma_outage": ("plane=sigma_outage",),
    "sigma_hub": ("plane=sigma_hub",),
    "sigma_hub_skfa": ("plane=sigma_hub", "hub_scheme=SKFA"),
}


class Reproduction:
    """Everything made below one folder, and compared with results/reference."""

    def __init__(self, results: Path, replicates: str, keeper: Keeper) -> None:
        self.results, self.replicates, self.keeper = results, replicates, keeper

    def sweep(self, name: str, *overrides: str) -> None:
        """Run one study under a name; if it fails, end the program with the exit code."""
        run_command("sweep", f"results={self.results}", f"name={name}", *overrides)
        self.keeper.keep_rows(name)

    def report(self, name: str) -> None:
        """Draw all figures of a run, and write the report that compares it with the paper."""
        run = self.results / name
        run_command("figures", str(run))
        for figure in PAPER_FIGURES:
            run_module(f"ren2019.{figure}", run)
        run_module("ren2019.fidelity", run)

    def make_all(self) -> None:
        """Make the searches, the runs, the ablations, the two maps side by side, and the plant."""
        self.sweep("readings", "experiment=readings")
        self.keeper.keep("readings")
        for name, overrides in RUNS.items():
            self.sweep(name, f"grid.replicates={self.replicates}", *overrides)
            self.report(name)
            self.keeper.keep(name)
        for name, overrides in ABLATIONS.items():
            words = ["experiment=paper", "tuning=paper", "schemes=[HME1,HME2]"]
            self.sweep(name, *words, f"grid.replicates={self.replicates}", *overrides)
            self.keeper.keep(name)
        paper, matched = (owtsweep.load(self.results / n) for n in ("paper", "matched_on_paper"))
        png, _ = two_maps.save(paper, matched, self.results / "two_maps")
        self.keeper.keep_file(png)
        self.make_rivals()
        self.make_plant()
        self.make_better()
        self.make_tower()
        self.make_floater()
        self.make_blade()
        self.make_mating()

    def make_rivals(self) -> None:
        """Search the rival explanations of table 8, judge them, and make the EKF's trade-off."""
        self.sweep("rivals", "experiment=rivals")
        folder = self.results / "rivals"
        run_module("ren2019.judge_rivals", folder, self.replicates, folder / "judged.csv")
        self.keeper.keep("rivals")
        run_module("ren2019.ekf_trade_off", self.results)
        for ending in ("csv", "png"):
            self.keeper.keep_file(self.results / f"ekf_trade_off.{ending}")

    def make_plant(self) -> None:
        """Make the runs, tables and pictures of the plant, and what a tilt of the IMU costs."""
        for name, overrides in PLANT.items():
            self.sweep(name, f"grid.replicates={self.replicates}", *overrides)
        folder, seas = self.results / "plant", self.results / "plant_seas"
        folder.mkdir(exist_ok=True)
        plant.make_all(self.results / "both_tunings", folder)
        run_command("figures", str(seas))
        run_module("ren2019.fidelity", seas)
        for name in ("figure_03_record", "figure_04_spectrum"):
            shutil.copy(seas / "figures" / f"{name}.png", folder)
        for name in TIME_HISTORIES:  # figures 9 to 14, in the sea of their captions
            shutil.copy(seas / "figures" / f"{name}_paper.png", folder / f"{name}.png")
        for tuning in ("paper", "matched"):
            claims = seas / "fidelity" / tuning / "fidelity_claims.csv"
            shutil.copy(claims, folder / f"fidelity_claims_{tuning}.csv")
        run_module("ren2019.plant_spectrum", folder / "plant_spectrum.csv")
        run_module("plant_tilt", folder / "plant_tilt.csv")
        self.keeper.keep("plant")
        run_module("tilt", self.results / "tilt")
        self.keeper.keep_file(self.results / "tilt" / "tilt_cost.png", Path("docs/images"))

    def make_better(self) -> None:
        """Set the schemes beside the bounds of their errors; run SKFA and SWITCH in seas that move.

        Twenty records per cell at most: SKF and SKFA run each amplitude by itself.
        """
        folder = self.results / "better"
        replicates = str(min(int(self.replicates), 20))
        words = [f"results={self.results}", "name=better_run"]
        run_module("better", folder, replicates, *words)
        run_module("moving_sea", folder)
        run_module("switching", folder, f"results={self.results}")
        few = str(min(int(self.replicates), 8))
        run_module("departures", folder, few, f"results={self.results}")
        self.keeper.keep("better")

    def make_tower(self) -> None:
        """Sweep the tower study with both tunings, judge its paper, find crossings, places, maps.

        Of each sweep the maps and the means of the criteria are kept.
        """
        folder = self.results / "tower"
        folder.mkdir(exist_ok=True)
        for tuning in ("paper", "matched"):
            name = f"tower_{tuning}"
            self.sweep(name, "study=tower", f"tuning={tuning}")
            run_command("figures", str(self.results / name))
            run = owtsweep.load(self.results / name)
            summary = run.summary()
            kept = summary[summary["measure"].isin([*CRITERIA, ""])]
            write_table(folder, f"summary_{tuning}", kept)
            write_table(folder, f"best_scheme_{tuning}", run.table("best_scheme"))
            for map_ in sorted((self.results / name / "figures").glob("map_*.png")):
                shutil.copy(map_, folder / f"{map_.stem}_{tuning}.png")
        run_module("tower.crossover", folder, f"results={self.results}")
        run_module("tower.placement", folder)
        run_module("tower.model_errors", folder)
        run_module("simpson2025.wave_yaw", folder)
        run_module("tower.declared_noise", folder)
        run_module("simpson2025.fidelity", folder)
        self.keeper.keep("tower")

    def make_floater(self) -> None:
        """Sweep the floater study over each plane, judge its paper, find delay margins.

        Of each sweep the means of the criteria and the maps by velocity are kept.
        """
        folder = self.results / "floater"
        folder.mkdir(exist_ok=True)
        for plane in PLANES:
            name = f"floater_{plane}"
            self.sweep(name, "study=floater", f"plane={plane}", "tuning=[paper,matched]")
            run_command("figures", str(self.results / name))
            run = owtsweep.load(self.results / name)
            summary = run.summary()
            kept = summary[summary["measure"].isin([*floater_measures.CRITERIA, ""])]
            write_table(folder, f"summary_{plane}", kept)
            write_table(folder, f"best_scheme_{plane}", run.table("best_scheme"))
            for tuning in ("paper", "matched"):
                map_ = self.results / name / "figures" / f"map_velocity_{tuning}.png"
                shutil.copy(map_, folder / f"map_{plane}_{tuning}.png")
        run_module("floater.delay_margin", folder)
        run_module("mehammer2018.fidelity", folder)
        self.keeper.keep("floater")

    def make_blade(self) -> None:
        """Sweep the blade study over its planes and grades, and judge its paper.

        Of each sweep the means of the criteria, velocities and NEES are kept, and two maps.
        """
        folder = self.results / "blade"
        folder.mkdir(exist_ok=True)
        measures = [*blade_measures.CRITERIA, "velocity", "nees", ""]
        for name, overrides in BLADE.items():
            self.sweep(
                f"blade_{name}", "study=blade", *overrides, f"grid.replicates={BLADE_RECORDS}"
            )
            run_command("figures", str(self.results / f"blade_{name}"))
            run = owtsweep.load(self.results / f"blade_{name}")
            summary = run.summary()
            write_table(folder, f"summary_{name}", summary[summary["measure"].isin(measures)])
            write_table(folder, f"best_scheme_{name}", run.table("best_scheme"))
            for criterion in ("root", "worst"):
                map_ = self.results / f"blade_{name}" / "figures" / f"map_{criterion}.png"
                shutil.copy(map_, folder / f"map_{criterion}_{name}.png")
        run_module("maes2018.fidelity", folder, BLADE_JUDGED)
        run_module("maes2018.figures", folder)
        run_module("blade.left_out", folder)
        self.keeper.keep("blade")

    def make_mating(self) -> None:
        """Sweep the mating study; keep tables and pictures of the chances."""
        folder = self.results / "mating"
        folder.mkdir(exist_ok=True)
        for name, overrides in MATING.items():
            run = self.results / f"mating_{name}"
            self.sweep(run.name, "study=mating", *overrides)
            run_command("figures", str(run))
            write_table(folder, f"summary_{name}", owtsweep.load(run).summary())
            write_table(folder, f"best_scheme_{name}", owtsweep.load(run).table("best_scheme"))
            for picture in ("chances", "map_wrong"):
                shutil.copy(run / "figures" / f"{picture}.png", folder / f"{picture}_{name}.png")
        self.keeper.keep("mating")


def run_command(*words: str) -> None:
    """Run one command of owtsweep; if it fails, end the program with the exit code."""
    print("$ python -m owtsweep", *words, flush=True)
    code = main(list(words))
    if code:
        sys.exit(code)


def run_module(name: str, *words: object) -> None:
    """Run one module of experiments/; if it fails, end the program with the exit code."""
    words = ("-m", f"experiments.{name}", *words)
    print("$ python", *words, flush=True)
    code = subprocess.run([sys.executable, *map(str, words)], check=False).returncode
    if code:
        sys.exit(code)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description="Make everything behind the reports and pictures of docs/."
    )
    parser.add_argument("replicates", nargs="?", default="100", help="records per cell")
    parser.add_argument(
        "--check",
        nargs="?",
        choices=("all", "numbers"),
        const="all",
        help="compute anew, compare (all, or numbers alone), copy nothing",
    )
    parser.add_argument(
        "--against",
        type=Path,
        metavar="FOLDER",
        help="with --check=numbers: compare with this folder, not with results/reference",
    )
    options = parser.parse_args()
    if options.against and options.check != "numbers":
        parser.error("--against: use it with --check=numbers")
    if options.against and not options.against.is_dir():
        parser.error(f"--against: there is no folder {options.against}")
    with tempfile.TemporaryDirectory() as scratch:
        results = Path(scratch) if options.check else Path("results")
        keeper = Keeper(results, copies=not options.check)
        if options.check == "numbers":
            keeper = NumbersKeeper(results, options.against or REFERENCE)
        Reproduction(results, options.replicates, keeper).make_all()
    if options.check and keeper.differing:
        sys.exit(f"{len(keeper.differing)} files differ: {', '.join(keeper.differing)}")
