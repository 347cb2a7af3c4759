"""`owtsweep init` writes files that keep their contracts, and refuses bad names in one line."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from pathlib import Path
from string import Template

import pytest

from owtsweep.cli import main
from owtsweep.cli.init import FILES, STUDIES, TEMPLATES
from owtsweep.structures import compute_modes, read_structure

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def check(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("study", STUDIES)
def test_a_scheme_keeps_its_contract(study: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "scheme", "my_filter", f"study={study}"]) == 0
    out = capsys.readouterr().out
    assert out.splitlines()[:3] == ["my_filter.py", "next:", "  python my_filter.py"]
    assert f"study={study} " in out
    if study == "hub":  # one as a user runs it, the others in this process
        told = check([sys.executable, "my_filter.py"])
    else:
        runpy.run_path("my_filter.py", run_name="__main__")
        told = capsys.readouterr().out
    assert told == "MyFilter keeps the contract\n"
    ruff = [
        sys.executable,
        "-m",
        "ruff",
        "check",
        "--isolated",
        "--select=E,F,W,B",
        "--line-length=100",
    ]
    check([*ruff, "my_filter.py"])


def test_a_structure_can_be_computed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "structure", "my_tower"]) == 0
    assert "structure=./my_tower.yaml" in capsys.readouterr().out
    structure = read_structure("my_tower.yaml")
    assert structure.name == "my_tower"
    assert 0.2 < compute_modes(structure, 1, 0).frequency[0] < 0.5


def test_a_study_is_the_tested_one(capsys: pytest.CaptureFixture[str]) -> None:
    """tests/docs/test_contributing.py installs the study of CONTRIBUTING.md and runs it."""
    assert main(["init", "study", "constant"]) == 0
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    example = page.partition("### A whole study")[2].partition("\n## ")[0]
    shown = re.findall(
        r"^`([\w./]+)`[^\n]*:\n\n```\w+\n(.*?)^```", example, re.DOTALL | re.MULTILINE
    )
    assert len(shown) == 4
    for name, text in shown:
        assert Path("owtsweep-constant", name).read_text(encoding="utf-8") == text


def test_a_study_of_another_name_keeps_the_contract(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["init", "study", "other_one"]) == 0
    folder = Path("owtsweep-other_one").resolve()
    text = "".join(path.read_text(encoding="utf-8") for path in folder.rglob("*.*"))
    assert 'other_one = "other_one_study:OtherOneStudy"' in text
    assert not re.search(r"constant_study|Constant", text)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["scheme", "My-Filter"], "NAME: 'My-Filter' cannot be used"),
        (["scheme", "class"], "NAME: 'class' cannot be used"),
        (["scheme", "numpy"], "NAME: 'numpy' is a module of Python already"),
        (["study", "blade"], "NAME: 'blade' is a study already"),
        (["scheme", "mine", "study=mating"], "study: 'mating' takes no scheme from a template"),
        (["scheme", "mine", "tuning=paper"], "tuning=paper: only study=... may follow the name"),
        (["structure", "mine", "study=hub"], "study=hub: only a scheme belongs to a study"),
        (["world", "mine"], "argument kind: invalid choice: 'world'"),
        (["scheme"], "the following arguments are required: NAME"),
    ],
)
def test_a_slip_is_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"owtsweep: {says}")
    assert not any(Path().iterdir())


def test_nothing_is_overwritten(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.py").write_text("precious")
    assert main(["init", "scheme", "mine"]) == 2
    assert capsys.readouterr().err == (
        "owtsweep: NAME: mine.py is there already; choose another name\n"
    )
    assert Path("mine.py").read_text() == "precious"


def test_every_template_is_used_and_can_be_filled() -> None:
    named = {template for files in FILES.values() for template in files.values()}
    used = {Template(name).substitute(study=study) for name in named for study in STUDIES}
    assert used == {path.stem for path in TEMPLATES.iterdir()}
