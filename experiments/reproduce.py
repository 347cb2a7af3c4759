"""Make everything behind the reports and pictures of docs/: runs, figures.

    python -m experiments.reproduce [REPLICATES] [--check[=numbers]] [--against FOLDER]

The script runs what is missing below results/ (100 records per cell by default), draws the figures
and writes the reports. Then it compares the small outputs with results/reference/, says how far
they agree, and copies those that differ to results/reference/. With --check everything is computed
anew in a temporary folder, nothing is copied, and the exit code is 1 if something differs. `make
reproduce` calls this script; reproduce.toml lists the parts.

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
from experiments.keeping import PARTS, REFERENCE, Keeper, NumbersKeeper
from owtsweep.cli import main
from owtsweep.io.tables import write_table


class Reproduction:
    """Everything made below one folder, and compared with results/reference."""

    def __init__(self, results: Path, replicates: int, keeper: Keeper) -> None:
        self.results, self.keeper = results, keeper
        self.values = {
            "results": results,
            "replicates": replicates,
            "at_most_20": min(replicates, 20),
            "at_most_8": min(replicates, 8),
        }

    def make(self, part: str) -> None:
        """Make one part of reproduce.toml, and compare it with results/reference."""
        wanted = PARTS[part]
        for name, overrides in wanted.get("sweeps", {}).items():
            self.sweep(f"{part}_{name}", f"study={part}", *overrides.split())
            self.figures(f"{part}_{name}")
            self.tabulate(f"{part}_{name}", part, name, wanted.get("measures"))
            for pattern in wanted["pictures"]:
                source, target = pattern.format(sweep=name).split()
                self.copy(f"{part}_{name}/figures/{source}", f"{part}/{target}")
        for step in wanted.get("steps", ()):
            verb, *words = (word.format(**self.values) for word in step.split())
            getattr(self, verb)(*words)
        if "keep" in wanted:
            self.keeper.keep(part)
        for file in wanted.get("files", ()):
            source, *reference = file.split()
            self.keeper.keep_file(self.results / source, *map(Path, reference))

    def sweep(self, name: str, *overrides: str) -> None:
        """Run one study under a name; if it fails, end the program with the exit code."""
        self.command("sweep", f"results={self.results}", f"name={name}", *overrides)
        self.keeper.keep_rows(name)

    def figures(self, name: str) -> None:
        """Draw all figures of a run."""
        self.command("figures", str(self.results / name))

    def report(self, name: str) -> None:
        """Draw all figures of a run, and write the report that compares it with the paper."""
        self.figures(name)
        run = str(self.results / name)
        self.script("ren2019.figures", run, "figure_15", "figure_16", "figure_17")
        self.script("ren2019.tables_6_to_9", run)
        self.script("ren2019.fidelity", run)

    def tabulate(self, run: str, folder: str, name: str, measures: list[str] | None) -> None:
        """Write a run's means of some measures, and its best schemes, into a part's folder."""
        made, target = owtsweep.load(self.results / run), self.results / folder
        target.mkdir(exist_ok=True)
        summary = made.summary()
        kept = summary if measures is None else summary[summary["measure"].isin(measures)]
        write_table(target, f"summary_{name}", kept)
        write_table(target, f"best_scheme_{name}", made.table("best_scheme"))

    def copy(self, source: str, target: str) -> None:
        """Copy files; what `*` stands for in the source stands in the target, too."""
        before, star, after = source.partition("*")
        files = sorted(self.results.glob(source))
        if not files:
            sys.exit(f"{source}: nothing of this name was made")
        for file in files:
            found = file.relative_to(self.results).as_posix()
            stands = found[len(before) : len(found) - len(after)] if star else ""
            shutil.copy(file, self.results / target.replace("*", stands))

    def command(self, *words: str) -> None:
        """Run one command of owtsweep; if it fails, end the program with the exit code."""
        print("$ python -m owtsweep", *words, flush=True)
        code = main(list(words))
        if code:
            sys.exit(code)

    def script(self, name: str, *words: str) -> None:
        """Run one module of experiments/; if it fails, end the program with the exit code."""
        words = ("-m", f"experiments.{name}", *words)
        print("$ python", *words, flush=True)
        code = subprocess.run([sys.executable, *words], check=False).returncode
        if code:
            sys.exit(code)


def read_options() -> argparse.Namespace:
    """Return the options of the command line, or end the program."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("replicates", nargs="?", default=100, type=int, help="records per cell")
    about = "compute anew, compare (all, or numbers alone), copy nothing"
    parser.add_argument("--check", nargs="?", choices=("all", "numbers"), const="all", help=about)
    about = "with --check=numbers: compare with this folder, not with results/reference"
    parser.add_argument("--against", type=Path, metavar="FOLDER", help=about)
    options = parser.parse_args()
    if options.against and options.check != "numbers":
        parser.error("--against: use it with --check=numbers")
    if options.against and not options.against.is_dir():
        parser.error(f"--against: there is no folder {options.against}")
    return options


if __name__ == "__main__":
    options = read_options()
    with tempfile.TemporaryDirectory() as scratch:
        results = Path(scratch) if options.check else Path("results")
        keeper = Keeper(results, copies=not options.check)
        if options.check == "numbers":
            keeper = NumbersKeeper(results, options.against or REFERENCE)
        reproduction = Reproduction(results, options.replicates, keeper)
        for part in PARTS:
            reproduction.make(part)
    if options.check and keeper.differing:
        sys.exit(f"{len(keeper.differing)} files differ: {', '.join(keeper.differing)}")
