"""Each example of the gallery runs, anywhere, and ends in a picture."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"
SCRIPTS = sorted(path.stem for path in GALLERY.glob("*.py") if path.stem != "alpha_beta")
#: Runs a script as the shell does, and counts its pictures.
RUN = """
import runpy, sys
sys.path.insert(0, sys.argv[1].rpartition("/")[0])
runpy.run_path(sys.argv[1], run_name="__main__")
import matplotlib.pyplot as plt
print(len(plt.get_fignums()), "pictures")
"""


def test_there_is_one_for_each_job() -> None:
    assert len(SCRIPTS) == 10


@pytest.mark.faults
@pytest.mark.parametrize("name", SCRIPTS)
def test_an_example_ends_in_a_picture(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(GALLERY / f"{name}.py")],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=300.0,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "1 pictures"
