"""Make everything behind the reports and pictures of docs/: searches, runs, figures.

    python experiments/reproduce.py [REPLICATES] [--check]

The script runs what is missing below results/ (100 records per cell by default), draws the figures
and writes the reports. Then it compares the small outputs with results/reference/, says how far
they agree, and copies those that differ to results/reference/. With --check everything is computed
anew in a temporary folder, nothing is copied, and the exit code is 1 if something differs. `make
reproduce` calls this script.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image  # comes with matplotlib
from PIL.PngImagePlugin import PngInfo

import owtsweep
import plant
from agreement import PROVENANCE, compare_folders, largest_difference
from owtsweep.cli import main
from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.studies.blade import measures as blade_measures
from owtsweep.studies.floater import measures as floater_measures
from owtsweep.studies.hub.figures import two_maps
from owtsweep.studies.tower.measures import CRITERIA

REFERENCE = Path("results/reference")
SCRIPTS = Path(__file__).parent
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
#: Pictures that get fewer colours than others, because they would be large: folder/name -> number.
COLOURS = {"plant/figure_03_record.png": 32}
#: Maps of the floater study.
PLANES = ("delay_bias", "snr_loss", "believed_snr", "roll_snr")
#: The blade's schemes without UKF and INVARIANT_EKF: these agree with MEKF within 1 %, so they run
#: with the tactical unit only.
BLADE_WITHOUT_ALIKE = (
    "schemes=[HOLD,GNSS_WAHBA,COMPLEMENTARY,MEKF,MEKF_HEADING,MEKF_OFFSET,MEKF_LEVER,PENDULUM,"
    "FIXED_LAG,SMOOTHER,DOUBLE_INTEGRATION,TOTAL_STATIONS]"
)
#: Sweeps of the blade study -> overrides.
BLADE = {
    "sigma_outage_tactical": ("unit=tactical",),
    "sigma_outage_fog": ("unit=fog", BLADE_WITHOUT_ALIKE),
    "sigma_outage_mems": ("unit=mems", BLADE_WITHOUT_ALIKE),
    "offset_sigma": (
        "plane=offset_sigma",
        "schemes=[HOLD,GNSS_WAHBA,COMPLEMENTARY,MEKF,MEKF_HEADING,MEKF_OFFSET,PENDULUM]",
    ),
}
#: Records per cell of these sweeps: a map of the usual 4 tells too few schemes apart. Records that
#: are judged.
BLADE_RECORDS, BLADE_JUDGED = 10, 40
#: Maps of the mating study.
MATING = ("sigma_outage", "sigma_hub")
TABLES = ("config.yaml", "manifest.json", "best_scheme.csv", "fidelity/fidelity.csv")
ALL = (
    *TABLES, "summary.csv", "figures/figure_*.png", "figures/error_spectra.png", "figures/*.csv",
    "figures/*.md", "fidelity/*.csv", "fidelity/*.md", "fidelity/figures/*.png",
)  # fmt: skip
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
        "*.md",
        "*.png",
    ),
    "mating": ("summary_*.csv", "best_scheme_*.csv", "*.png"),
    **dict.fromkeys(ABLATIONS, (*TABLES, "summary.csv", "figures/figure_18*.png")),
}


class Reproduction:
    """The runs below one folder, and the list of files that differ from results/reference."""

    def __init__(self, results: Path, replicates: str, *, check: bool) -> None:
        self.results, self.replicates, self.check = results, replicates, check
        self.differing: list[str] = []

    def sweep(self, name: str, *overrides: str) -> None:
        """Run one study under a name; if it fails, end the program with the exit code."""
        run_command("sweep", f"results={self.results}", f"name={name}", *overrides)

    def report(self, name: str) -> None:
        """Draw all figures of a run, and write the report that compares it with the paper."""
        run_command("figures", str(self.results / name))
        run_command("fidelity", str(self.results / name))

    def keep(self, name: str) -> None:
        """Compare a run's small outputs with results/reference/<name>; copy them if they differ."""
        with tempfile.TemporaryDirectory() as folder:
            made, kept = Path(folder), REFERENCE / name
            for pattern in KEPT[name]:
                for file in sorted((self.results / name).glob(pattern)):
                    copy_small(file, made / file.name)
            differences = compare_folders(made, kept)
            self.tell(name, differences, largest_difference(made, kept))
            if differences and not self.check:
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
            if differences and not self.check:
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

    def make_all(self) -> None:
        """Make the searches, the runs, the ablations, the two maps side by side, and the plant."""
        self.sweep("readings", "experiment=readings")
        self.keep("readings")
        for name, overrides in RUNS.items():
            self.sweep(name, f"grid.replicates={self.replicates}", *overrides)
            self.report(name)
            self.keep(name)
        for name, overrides in ABLATIONS.items():
            words = ["experiment=paper", "tuning=paper", "schemes=[HME1,HME2]"]
            self.sweep(name, *words, f"grid.replicates={self.replicates}", *overrides)
            self.keep(name)
        paper, matched = (owtsweep.load(self.results / n) for n in ("paper", "matched_on_paper"))
        metadata = {"paper": paper.hash, "matched": matched.hash}
        figure = two_maps.draw(paper, matched)
        png, _ = style.save(figure, self.results, "two_maps", metadata)
        self.keep_file(png)
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
        run_script("judge_rivals.py", folder, self.replicates, folder / "judged.csv")
        self.keep("rivals")
        run_script("ekf_trade_off.py", self.results)
        for ending in ("csv", "png"):
            self.keep_file(self.results / f"ekf_trade_off.{ending}")

    def make_plant(self) -> None:
        """Make the runs, tables and pictures of the plant, and what a tilt of the IMU costs."""
        for name, overrides in PLANT.items():
            self.sweep(name, f"grid.replicates={self.replicates}", *overrides)
        folder, seas = self.results / "plant", self.results / "plant_seas"
        folder.mkdir(exist_ok=True)
        plant.make_all(self.results / "both_tunings", folder)
        self.report("plant_seas")
        for name in ("figure_03_record", "figure_04_spectrum"):
            shutil.copy(seas / "figures" / f"{name}.png", folder)
        for tuning in ("paper", "matched"):
            claims = seas / "fidelity" / tuning / "fidelity_claims.csv"
            shutil.copy(claims, folder / f"fidelity_claims_{tuning}.csv")
        run_script("plant_spectrum.py", folder / "plant_spectrum.csv")
        run_script("plant_tilt.py", folder / "plant_tilt.csv")
        self.keep("plant")
        run_script("tilt.py", self.results / "tilt")
        self.keep_file(self.results / "tilt" / "tilt_cost.png", Path("docs/images"))

    def make_better(self) -> None:
        """Set the schemes beside the bounds of their errors; run SKFA in seas that move.

        Twenty records per cell at most: SKF and SKFA run each amplitude by itself.
        """
        folder = self.results / "better"
        replicates = str(min(int(self.replicates), 20))
        words = [f"results={self.results}", "name=better_run"]
        run_script("better.py", folder, replicates, *words)
        run_script("moving_sea.py", folder)
        self.keep("better")

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
            write_table(folder, f"best_scheme_{tuning}", run.best_scheme())
            for map_ in sorted((self.results / name / "figures").glob("map_*.png")):
                shutil.copy(map_, folder / f"{map_.stem}_{tuning}.png")
        run_script("tower/crossover.py", folder, f"results={self.results}")
        run_script("tower/placement.py", folder)
        run_script("tower/model_errors.py", folder)
        run_script("tower/wave_yaw.py", folder)
        run_script("tower/fidelity.py", folder)
        self.keep("tower")

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
            write_table(folder, f"best_scheme_{plane}", run.best_scheme())
            for tuning in ("paper", "matched"):
                map_ = self.results / name / "figures" / f"map_velocity_{tuning}.png"
                shutil.copy(map_, folder / f"map_{plane}_{tuning}.png")
        run_script("floater/delay_margin.py", folder)
        run_script("floater/fidelity.py", folder)
        self.keep("floater")

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
            write_table(folder, f"best_scheme_{name}", run.best_scheme())
            for criterion in ("root", "worst"):
                map_ = self.results / f"blade_{name}" / "figures" / f"map_{criterion}.png"
                shutil.copy(map_, folder / f"map_{criterion}_{name}.png")
        run_script("blade/fidelity.py", folder, str(BLADE_JUDGED))
        run_script("blade/figures.py", folder)
        self.keep("blade")

    def make_mating(self) -> None:
        """Sweep the mating study over its planes; keep tables and pictures of the chances."""
        folder = self.results / "mating"
        folder.mkdir(exist_ok=True)
        for plane in MATING:
            run = self.results / f"mating_{plane}"
            self.sweep(run.name, "study=mating", f"plane={plane}")
            run_command("figures", str(run))
            write_table(folder, f"summary_{plane}", owtsweep.load(run).summary())
            write_table(folder, f"best_scheme_{plane}", owtsweep.load(run).best_scheme())
            for picture in ("chances", "map_wrong"):
                shutil.copy(run / "figures" / f"{picture}.png", folder / f"{picture}_{plane}.png")
        self.keep("mating")


def run_command(*words: str) -> None:
    """Run one command of owtsweep; if it fails, end the program with the exit code."""
    print("$ python -m owtsweep", *words, flush=True)
    code = main(list(words))
    if code:
        sys.exit(code)


def run_script(name: str, *words: object) -> None:
    """Run one script of this folder; if it fails, end the program with the exit code."""
    command = [sys.executable, SCRIPTS / name, *words]
    print("$ python", *command[1:], flush=True)
    code = subprocess.run([str(word) for word in command], check=False).returncode
    if code:
        sys.exit(code)


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


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description="Make everything behind the reports and pictures of docs/."
    )
    parser.add_argument("replicates", nargs="?", default="100", help="records per cell")
    parser.add_argument("--check", action="store_true", help="compute anew, compare, copy nothing")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        results = Path(scratch) if options.check else Path("results")
        reproduction = Reproduction(results, options.replicates, check=options.check)
        reproduction.make_all()
    if options.check and reproduction.differing:
        sys.exit(f"{len(reproduction.differing)} files differ: {', '.join(reproduction.differing)}")
