"""The installed program works anywhere: from a wheel and from an editable checkout.

Nothing is downloaded: each installation goes into a fresh environment that borrows the
dependencies of the one that runs the tests.
"""

from __future__ import annotations

import os
import site
import subprocess
import sys
import venv
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest

CHECKOUT = Path(__file__).resolve().parents[1]
SWEEP = (
    "sweep",
    "grid.natural_period=[4.0]",
    "grid.amplitude=[0.2]",
    "grid.replicates=1",
    "record.duration=40",
    "schemes=[MKF]",
    "baselines=[]",
)


def run(
    *command: str | Path, cwd: Path, env: Mapping[str, str]
) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env=env,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=120.0,
        check=False,
    )
    assert done.returncode == 0, f"{command} ended with {done.returncode}:\n{done.stderr}"
    return done


def make_environment(folder: Path) -> Path:
    """A fresh environment that borrows this one's packages; returns its interpreter."""
    venv.create(folder, symlinks=True, with_pip=False)
    python = folder / "bin" / "python"
    (site_packages,) = folder.glob("lib/python*/site-packages")
    # Paths in a .pth come after the folder it lies in, and .pth files there are not followed: an
    # editable owtsweep of this environment stays out of sight.
    borrowed = [path for path in site.getsitepackages() if Path(path).is_dir()]
    (site_packages / "borrowed.pth").write_text("\n".join(borrowed), encoding="utf-8")
    return python


# numba caches by the path of a source file: in the checkout the kernels are compiled already, in a
# fresh folder they would take longer than all the rest.
@pytest.mark.faults  # slow: environments of their own
@pytest.mark.parametrize(("kind", "engine"), [("wheel", "reference"), ("editable", "batch")])
@pytest.mark.usefixtures("kernels")
def test_installed_program_runs_in_an_empty_folder(kind: str, engine: str, tmp_path: Path) -> None:
    python = make_environment(tmp_path / "environment")
    folder = tmp_path / "empty"
    folder.mkdir()
    # PYTHONPATH would lead back to the checkout.
    env = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}

    run(
        *(sys.executable, "-m", "pip", "--python", python, "install", "--quiet"),
        *("--no-index", "--no-deps", "--no-build-isolation", "--ignore-installed"),
        *(("--editable", CHECKOUT) if kind == "editable" else (CHECKOUT,)),
        cwd=folder,
        env=env,
    )
    found = run(
        *(python, "-c", "from owtsweep import config as c; print(c.__file__, c.conf_directory())"),
        cwd=folder,
        env=env,
    )
    module, conf = map(Path, found.stdout.split())
    if kind == "wheel":
        assert module.is_relative_to(tmp_path.resolve() / "environment")
        assert conf == module.parents[1] / "conf"
    else:
        assert module == CHECKOUT / "src" / "owtsweep" / "config" / "__init__.py"
        assert conf == CHECKOUT / "conf"

    script = run(python.parent / "owtsweep", "--version", cwd=folder, env=env)
    assert script.stdout.strip()
    assert list(folder.iterdir()) == []

    run(python, "-m", "owtsweep", *SWEEP, f"engine={engine}", cwd=folder, env=env)
    (table,) = folder.glob("results/*/summary.csv")
    assert set(pd.read_csv(table)["scheme"]) == {"MKF"}
    assert list(table.parent.glob("figures/*.png"))
