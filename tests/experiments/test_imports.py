"""What experiments, benchmarks and examples import from the package is there; none is run."""

from __future__ import annotations

import ast
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = [
    path
    for folder in ("experiments", "benchmarks", "examples")
    for path in (ROOT / folder).rglob("*.py")
]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_names_of_the_package_are_there(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("owtsweep"):
            module = import_module(str(node.module))
            for name in (alias.name for alias in node.names):
                there = hasattr(module, name) or find_spec(f"{node.module}.{name}") is not None
                assert there, f"{node.module} has no {name}"
