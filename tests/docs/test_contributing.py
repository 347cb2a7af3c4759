"""CONTRIBUTING.md leads a stranger to a study: its example is installed and run as it stands."""

from __future__ import annotations

import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pandas as pd
import pytest

from owtsweep.cli import main

PAGE = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")
EXAMPLE = PAGE.partition("### A whole study")[2].partition("\n## ")[0]
#: Two thirds less to compute than on the page; two noises more.
FEW, NOISES = "grid.samples=[20]", "'grid.noise=[{log:[0.1,10,5]}]'"
ROOMS = "comparing|config|figures|results|streams|testing|verdicts"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of the example, by the names that the page gives them."""
    folder = tmp_path_factory.mktemp("stranger") / "owtsweep-constant"
    named = re.findall(
        r"^`([\w./]+)`[^\n]*:\n\n```\w+\n(.*?)^```", EXAMPLE, re.DOTALL | re.MULTILINE
    )
    for name, text in named:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    listed = re.findall(r"^  ([\w/]+\.\w+)$", EXAMPLE, re.MULTILINE)
    assert sorted(listed) == sorted(name for name, _ in named)
    return folder


@pytest.fixture(scope="module")
def site(project: Path) -> Path:
    """A folder into which pip has installed the example."""
    folder = project.parent / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    offline = ["--no-deps", "--no-build-isolation", "--no-index", "--target", str(folder)]
    done = subprocess.run(
        [*pip, *offline, str(project)], capture_output=True, text=True, timeout=120.0, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(autouse=True)
def _elsewhere(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(site))
    yield
    sys.modules.pop("constant_study", None)


def run(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    """What a command prints."""
    words = shlex.split(command, comments=True)
    assert words[:3] == ["python", "-m", "owtsweep"]
    assert main(words[3:]) == 0, capsys.readouterr().err
    return capsys.readouterr().out


def test_the_commands_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"^Then:\n\n```\n(.*?)^```", EXAMPLE, re.DOTALL | re.MULTILINE)
    install, listing, sweep, multirun, compare = block.splitlines()
    assert install.split()[:3] == ["pip", "install", "./owtsweep-constant"]

    assert "mean or the median?" in run(listing, capsys)
    sweep = f"{sweep} {FEW}"
    assert "600 cases computed" in run(sweep, capsys)
    assert "400 cases computed, 600 were there" in run(f"{sweep} {NOISES}", capsys)
    (folder,) = Path("results").glob("constant-*")
    assert {path.suffix for path in (folder / "figures").iterdir()} == {".png", ".svg"}
    assert "state" in run(f"python -m owtsweep show {folder}", capsys)
    assert "3 files" in run(f"python -m owtsweep figures {folder}", capsys)

    run(f"{multirun} {FEW}", capsys)
    (folder,) = Path("results").glob("multirun-*")
    shown = run(compare.replace("results/multirun-...", str(folder)), capsys)
    assert "outliers" in shown
    best = pd.read_csv(folder / "comparison/best_schemes.csv")
    assert best.groupby("outliers")["best"].unique().map(list).to_dict()[0.2] == ["median"]
    assert list((folder / "comparison").glob("best_scheme_maps.*"))


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("grid.nose=[1]", "grid.nose: there is no such key; did you mean grid.noise?"),
        ("grid.noise=[0]", "grid.noise[0]: 0 m must be a finite number above zero"),
        ("schemes=[mode]", "schemes[0]: 'mode' is none of mean, median"),
        ("engine=exact", "engine: 'exact' is not known; the study has one engine, batch"),
    ],
)
def test_a_slip_is_one_line(override: str, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "study=constant", override]) == 2
    assert capsys.readouterr().err == f"owtsweep: {says}\n"
    assert not any(Path().iterdir())


def test_the_example_passes_its_own_test(project: Path) -> None:
    tests = runpy.run_path(str(project / "tests/test_constant.py"))
    (test,) = (tests[name] for name in tests if name.startswith("test_"))
    test()


@pytest.mark.parametrize(
    "name", sorted(set(re.findall(rf"`(?:owtsweep\.)?((?:{ROOMS})\.(?!py`)\w[\w.]*)", PAGE)))
)
def test_every_name_on_the_page_is_public(name: str) -> None:
    found: Any = import_module("owtsweep")
    for part in name.split("."):
        inner = getattr(found, part, None)
        if inner is None:
            inner = import_module(f"{found.__name__}.{part}")
        elif isinstance(found, ModuleType) and not isinstance(inner, ModuleType):
            assert part in found.__all__
        found = inner
