"""docs/files_of_a_case.md lists the files that one case of the hub study runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from benchmarks.files_run import make_table

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "files_of_a_case.md"
ARCHITECTURE = ROOT / "docs" / "architecture.md"
#: In a process of its own, where nothing is imported yet.
TRACE = "from benchmarks.files_run import *; print(*trace(run_case), sep='\\n')"


@pytest.mark.usefixtures("kernels")
def test_the_page_lists_the_files_of_one_case() -> None:
    done = subprocess.run(
        [sys.executable, "-c", TRACE], cwd=ROOT, capture_output=True, text=True, check=True
    )
    page = PAGE.read_text("utf-8").partition("<!-- files of one case: begin -->\n")[2]
    listed = page.partition("<!-- files of one case: end -->")[0].splitlines()
    assert sorted(listed) == sorted(make_table(done.stdout.split()).splitlines()), (
        "run python -m benchmarks.files_run --page"
    )


def test_what_leads_from_algorithm_1_to_its_kernel_is_on_the_way() -> None:
    text, table = ARCHITECTURE.read_text("utf-8"), PAGE.read_text("utf-8")
    *python, kernel = re.findall(r"src/owtsweep/(studies/hub/[\w/]+\.py)", text)
    assert python == ["studies/hub/schemes/hme1.py", "studies/hub/chain.py"]
    assert all(f"`{file}`" in table for file in python)
    batch = (ROOT / "src" / "owtsweep" / "studies" / "hub" / "batch.py").read_text("utf-8")
    assert f"from owtsweep.studies.hub.kernels.{Path(kernel).stem} import run\n" in batch
