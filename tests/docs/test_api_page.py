"""docs/api.md names all that is public, each name with an example that runs."""

from __future__ import annotations

import doctest
import re
from importlib import import_module
from inspect import getdoc
from pathlib import Path
from typing import Any

import pytest

import owtsweep
from owtsweep import testing
from owtsweep.cli.init import TEMPLATES

PAGE = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
LISTED = re.findall(r"^\.\. auto(?:class|function|exception):: ([\w.]+)", PAGE, re.MULTILINE)
#: Name -> its methods on the page.
MEMBERS = {
    name: members.split(", ")
    for name, members in re.findall(r":: ([\w.]+)\n   :members: (.*)", PAGE)
}
OURS = [name for name in LISTED if re.fullmatch(r"owtsweep\.(testing\.)?\w+", name)]
TEMPLATE = "".join(path.read_text(encoding="utf-8") for path in TEMPLATES.iterdir())


def find(name: str) -> Any:
    module, _, leaf = name.rpartition(".")
    if module.startswith("owtsweep.schemes."):
        return getattr(getattr(import_module("owtsweep.schemes"), module.split(".")[-1]), leaf)
    return getattr(import_module(module), leaf)


def test_the_page_lists_what_is_public() -> None:
    public = {f"owtsweep.{name}" for name in owtsweep.__all__ if name != "__version__"}
    public |= {f"owtsweep.testing.{name}" for name in testing.__all__}
    assert set(OURS) == public


@pytest.mark.parametrize("name", LISTED)
def test_each_name_is_described(name: str) -> None:
    found = find(name)
    assert getdoc(found), name
    for member in MEMBERS.get(name, []):
        assert getdoc(getattr(found, member)), f"{name}.{member}"


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("name", OURS)
def test_its_example_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    found = find(name)
    text = found.__doc__
    examples = doctest.DocTestParser().get_doctest(text, {found.__name__: found}, name, None, 0)
    assert examples.examples, f"{name} has no example"
    said = [example.source for example in examples.examples]
    for member in MEMBERS.get(name, []):
        assert any(f".{member}" in line for line in said), f"{name} shows no {member}"
    runner = doctest.DocTestRunner()
    assert runner.run(examples).failed == 0, capsys.readouterr().out


def test_what_schemes_and_studies_import_is_in_a_template() -> None:
    elsewhere = {"Source", "Motion", "Sensors", "Estimator"}
    for name in set(LISTED) - set(OURS):
        leaf = name.rpartition(".")[2]
        if leaf in {"Setting", "Known", "Measured"}:  # the arguments of a scheme
            leaf = {"Setting": "known", "Known": "known", "Measured": "measured"}[leaf]
        assert leaf in elsewhere or re.search(rf"\b{leaf}\b", TEMPLATE), name
