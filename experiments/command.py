"""What scripts share: their command line, what they write and print, and work side by side."""

import sys
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
from joblib import Parallel, cpu_count
from matplotlib.figure import Figure

import owtsweep
from owtsweep.figures.drawings import save_figure
from owtsweep.io.tables import write_table
from owtsweep.io.terminal import tell_step
from owtsweep.sweep.runs import Run


def read_data(script: str) -> dict[str, Any]:
    """Return the data of the TOML file of a script's name; `script` is the script's `__file__`."""
    return tomllib.loads(Path(script).with_suffix(".toml").read_text("utf-8"))


class Words(NamedTuple):
    """The words of a command line: [FOLDER] [RECORDS] [NAME=VALUE ...]."""

    folder: Path
    records: int
    overrides: list[str]


def read_words(folder: str, records: int = 0) -> Words:
    """Return the words of the command line; `folder` and `records` stand for those left out."""
    overrides = [word for word in sys.argv[1:] if "=" in word]
    given = [word for word in sys.argv[1:] if "=" not in word]
    count = int(given[1]) if len(given) > 1 else records
    return Words(Path(given[0] if given else folder), count, overrides)


def write(
    folder: Path,
    tables: Mapping[str, pd.DataFrame],
    figures: Mapping[str, Callable[[], Figure]] | None = None,
    metadata: Mapping[str, str] | None = None,
) -> None:
    """Write tables and figures by name into a folder, which is made if need be; print the files.

    Figures are drawn in the package's style; `metadata` are texts to store inside their files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in tables.items():
        print(write_table(folder, name, table))
    for name, draw in (figures or {}).items():
        print(*save_figure(draw, metadata)(folder, name), sep="\n")


def show(table: pd.DataFrame, digits: int = 3) -> None:
    """Print a table whole."""
    print(table.to_string(index=False, float_format=f"{{:.{digits}g}}".format))


def draw_named(
    folder: str, known: Collection[str], draw: Callable[[list[str], Path], Iterable[Path]]
) -> None:
    """Draw figures by name, as the command line [FOLDER] [FIGURE ...] says; print their files.

    Without a folder they go into `folder`; without a figure all `known` ones are drawn.
    """
    target, *names = sys.argv[1:] or [folder]
    unknown = [name for name in names if name not in known]
    if unknown:
        sys.exit(f"there is no figure {unknown[0]}; use {', '.join(known)}")
    print(*draw(names or list(known), Path(target)), sep="\n")


def open_run() -> Run:
    """Return the run that the first argument names, or the default study, run first if needed."""
    return owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()


def compute(jobs: Mapping[str, Any]) -> list[Any]:
    """Return the results of delayed calls, in their order; tell the name of each when it is done.

    `jobs` maps names to calls that joblib's `delayed` made. They run in as many processes as there
    are cores.
    """
    results = Parallel(min(cpu_count(), len(jobs)), return_as="generator")(jobs.values())
    found = []
    for name, result in zip(jobs, results, strict=True):
        tell_step(name)
        found.append(result)
    return found
