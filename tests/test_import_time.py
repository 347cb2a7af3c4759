"""Importing the package costs next to nothing: heavy libraries wait until they are needed."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = {
    "casadi", "filterpy", "hydra", "joblib", "matplotlib", "numba", "numpy", "omegaconf",
    "pandas", "pyarrow", "pydantic", "pydantic_core", "pylife", "rich", "scipy", "seaborn",
}  # fmt: skip

HELP = """
from contextlib import suppress
from owtsweep.cli import main
with suppress(SystemExit):
    main([*{}, "--help"])
"""


def loaded_packages(statement: str) -> set[str]:
    """The top-level packages that a fresh interpreter holds after a statement."""
    code = f"{statement}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60.0
    )
    return {name.partition(".")[0] for name in done.stdout.split()}


@pytest.mark.parametrize(
    "statement",
    [
        "import owtsweep",
        "import owtsweep; dir(owtsweep)",
        "import owtsweep; owtsweep.InputError",
        "from owtsweep.cli import make_parser; make_parser().format_help()",
        HELP.format([]),
        HELP.format(["sweep"]),
    ],
    ids=["import", "dir", "error", "help", "--help", "sweep --help"],
)
def test_nothing_heavy_is_loaded(statement: str) -> None:
    packages = loaded_packages(statement)
    assert "owtsweep" in packages
    assert packages & HEAVY == set()


def test_exports_are_there_when_asked_for() -> None:
    packages = loaded_packages("from owtsweep import *\nassert callable(run) and callable(load)")
    assert "numpy" in packages


def test_a_map_is_drawn_without_seaborn() -> None:
    """It takes a second to import, and only curves and distributions are drawn with it."""
    modules = ("studies.hub.figures.maps_by_tuning", "figures.curves", "figures.distributions")
    packages = loaded_packages("\n".join(f"import owtsweep.{module}" for module in modules))
    assert "matplotlib" in packages
    assert "seaborn" not in packages
