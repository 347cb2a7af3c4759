"""Make undamaged runs and records once per session, and give each test a copy of what it needs."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import worlds


@pytest.fixture(scope="session")
def good(tmp_path_factory: pytest.TempPathFactory, kernels: None) -> Path:
    """Return a folder with the undamaged run `a`, multirun `m` and folder `records`."""
    folder = tmp_path_factory.mktemp("good")
    before = os.getcwd()
    os.chdir(folder)
    try:
        worlds.make_runs(folder)
        worlds.make_records(folder / "records")
    finally:
        os.chdir(before)
    return folder


@pytest.fixture
def copy(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Path]:
    """Return a function that copies a part of the folder `good` into the test's own folder.

    The function takes the part's name, e.g. "records/r.csv", and returns the path of the copy. The
    test's own folder becomes the current folder.
    """
    monkeypatch.chdir(tmp_path)

    def copy_part(name: str) -> Path:
        source = good / name
        if source.is_dir():
            return Path(shutil.copytree(source, tmp_path / source.name))
        for path in source.parent.glob("r.*" if source.suffix in (".sel", ".dat") else source.name):
            shutil.copy(path, tmp_path)
        return tmp_path / source.name

    return copy_part
