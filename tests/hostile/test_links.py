"""No command follows a link that lies in a run's folder."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest
from judge import Ended, judge, list_files

from owtsweep.cli.program import main
from worlds import TINY

#: Names of links in a run's folder whose targets commands would append to, write into, or read.
FILES = (
    "run.log", "config.yaml", "plan.json", "manifest.json", "summary.csv", "best_scheme.csv",
    "ratios.csv",
)  # fmt: skip
FOLDERS = ("cases", "figures", "asked", "fidelity", "spectrum", "fidelity/figures")


@pytest.fixture
def victim(copy, tmp_path: Path) -> Path:
    """A folder of the user's, outside of the run `a` that is copied beside it."""
    copy("a")
    folder = tmp_path / "victim"
    folder.mkdir()
    (folder / "profile").write_text("alias ll='ls -l'\n")
    return folder


def link(run: Path, name: str, target: Path) -> None:
    """Put a link in place of what is called `name` in a run's folder."""
    path = run / name
    path.parent.mkdir(exist_ok=True)
    if path.is_dir():
        shutil.move(path, target / path.name)
    path.unlink(missing_ok=True)
    path.symlink_to(target if name in FOLDERS else target / "profile")


def refused(words: list[str], folder: Path, name: str) -> Ended:
    """Check that a command is refused with the name of a link, and changes nothing."""
    before = list_files(folder)
    ended = judge(main, words, folder)
    assert ended.code == 2, ended
    assert f"{name}: this is a link where a " in ended.err
    assert list_files(folder) == before
    return ended


@pytest.mark.parametrize("name", [*FILES, *FOLDERS])
def test_no_command_follows_a_link(victim: Path, name: str) -> None:
    here = victim.parent
    link(here / "a", name, victim)
    for words in (
        ["sweep", *TINY, "results=.", "name=a"], ["sweep", *TINY, "results=.", "name=a", "--fresh",
        "--yes"], ["show", "a"], ["figures", "a"], ["fidelity", "a"], ["compare", "a", "a"],
        ["spectrum", *TINY, "results=.", "name=a"],
    ):  # fmt: skip
        refused(words, here, f"a/{name}")


def test_a_shard_that_is_a_link_counts_as_missing(victim: Path) -> None:
    shard = next((victim.parent / "a" / "cases").iterdir())
    shutil.move(shard, victim / shard.name)
    shard.symlink_to(victim / shard.name)
    ended = judge(main, ["show", "a"], victim.parent)
    assert "this is a link where a file belongs" in ended.err
    kept = list_files(victim)
    assert judge(main, ["sweep", *TINY, "results=.", "name=a"], victim.parent).code == 0
    assert not shard.is_symlink()
    assert list_files(victim) == kept


@pytest.mark.parametrize("name", ["multirun.json", "multirun.yaml", "comparison"])
def test_no_command_follows_a_link_beside_the_runs_of_a_multirun(
    copy, tmp_path: Path, name: str
) -> None:
    whole = copy("m")
    (tmp_path / "victim").mkdir()
    (tmp_path / "victim" / "profile").write_text("alias ll='ls -l'\n")
    (whole / name).unlink(missing_ok=True)
    target = tmp_path / "victim" / ("" if name == "comparison" else "profile")
    (whole / name).symlink_to(target)
    refused(["compare", "m"], tmp_path, f"m/{name}")
    words = [*TINY, "results=.", "seed=1,2"]
    digest = hashlib.blake2b("\n".join(sorted(words)).encode(), digest_size=5).hexdigest()
    whole.rename(tmp_path / f"multirun-{digest}")  # what this command would go on with
    refused(["sweep", "-m", *words], tmp_path, f"multirun-{digest}/{name}")


def test_no_command_follows_a_link_in_a_comparison(copy, tmp_path: Path) -> None:
    folder = copy("m") / "comparison"
    folder.mkdir()
    (tmp_path / "profile").write_text("alias ll='ls -l'\n")
    (folder / "comparison.md").symlink_to(tmp_path / "profile")
    refused(["compare", "m"], tmp_path, "m/comparison/comparison.md")
