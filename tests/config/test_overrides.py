"""Overrides and files of the user's own that cannot be: one line each, and no hang."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from owtsweep.config.composition import compose_plain
from owtsweep.errors import LONGEST, InputError, as_text
from owtsweep.studies.registry import find_tree

DEEP = "[" * 30 + "]" * 30

OVERRIDES = [
    ("\udcff=1", "no override"), ("seed=\x1b[31m", "no override"), ("", "no override"),
    ("=1", "no override"), ("+", "no override"), ("~x", "does not exist"),
    ("experiment=" + "x" * 5000, "config group"), ("results='\\${x}'", "cannot be stored"),
    (f"schemes={DEEP}", "more than 20 deep"),
    ("schemes=" + "[" * 200 + "]" * 200, "too deep"), ("seed=${nowhere}", "not found"),
    ("hydra.run.dir=x", "with --multirun only"),
    ("seed=" + "9" * 5000, "at most 4000 digits"), ("=", "no override"),
]  # fmt: skip


@pytest.mark.parametrize(("override", "message"), OVERRIDES, ids=[o[:20] for o, _ in OVERRIDES])
def test_bad_overrides_are_one_line(override: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        compose_plain(find_tree("hub"), [override])
    assert str(caught.value).isprintable()


ALIASES = "a: &a [x,x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{new}: &{new} [{','.join([f'*{old}'] * 10)}]\n"
    for old, new in zip("abcdefg", "bcdefgh", strict=True)
)
FILES = [
    (ALIASES, "stand for more than"), ("a: &a [*a]", "stand for more than"),
    (f"a: {DEEP}", "more than 20 deep"), ("{a: [", "cannot be read"), ("a: \0", "cannot be read"),
    ("a:\n\t- b", "cannot be read"), (b"\xff\xfe\xff", "no text in UTF-8"),
]  # fmt: skip


def write_group(folder: Path, **files: str | bytes) -> None:
    """Write files of the group `tuning`: name -> content."""
    (folder / "tuning").mkdir(parents=True)
    for name, content in files.items():
        data = content if isinstance(content, bytes) else content.encode()
        (folder / "tuning" / f"{name}.yaml").write_bytes(data)


def compose_from(folder: Path, *overrides: str) -> dict[str, Any]:
    return compose_plain(find_tree("hub"), overrides, str(folder))


@pytest.mark.parametrize("first", ["mine", "/tuning/mine", "mine@_global_.extra"])
@pytest.mark.parametrize(("content", "message"), FILES)
def test_a_group_file_is_looked_at_before_hydra_reads_it(tmp_path, content, message, first) -> None:
    write_group(tmp_path, mine=content, first=f"defaults: [{first}]\n")
    for chosen in ("mine", "first"):
        with pytest.raises(InputError, match=message) as caught:
            compose_from(tmp_path, "seed=1", f"tuning={chosen}")
        assert str(caught.value).startswith(f"{tmp_path / 'tuning' / 'mine.yaml'}: ")


def test_other_files_and_few_aliases_are_left_alone(tmp_path: Path) -> None:
    few = "# @package _global_\ntuning: mine\nband: &a [0.1, 0.3]\nfit_band: *a\n"
    write_group(tmp_path, mine=few, other="{bad")
    assert compose_from(tmp_path, "tuning=mine")["fit_band"] == [0.1, 0.3]
    with pytest.raises(InputError, match=r"^tuning: there is no 'nowhere'"):
        compose_from(tmp_path, "tuning=nowhere")


@pytest.mark.parametrize(
    "content", ["a: 1\na: 2", "a: !!python/name:os.system", "defaults: [mine]"]
)
def test_what_hydra_stumbles_over_is_one_line(tmp_path: Path, content: str) -> None:
    folder = tmp_path / "it's, mine" / "tuning"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_text(content)
    with pytest.raises(InputError, match=r"^config: ") as caught:
        compose_plain(find_tree("hub"), ["tuning=mine"], str(folder.parent))
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("name", ["it's, mine", "a\\b", "a\\\\b", "a\\", "${x}", "a'\\'b"])
def test_a_folder_may_have_any_name(tmp_path: Path, name: str) -> None:
    folder = tmp_path / name
    write_group(folder, mine="# @package _global_\nband: [0.1, 0.3]\n")
    assert compose_from(folder, "tuning=mine")["band"] == [0.1, 0.3]


@pytest.mark.parametrize("folder", ["a\0b", "x" * 5000, "loop", "nowhere", ""])
def test_a_folder_that_is_none_is_told(tmp_path, monkeypatch, folder: str) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    with pytest.raises(InputError, match=r"^--config-dir: .* is no folder$"):
        compose_plain(find_tree("hub"), [], folder)


def test_long_messages_lose_their_middle() -> None:
    long = "key: " + "x" * 10**6 + "; use y"
    assert len(str(InputError(long))) <= LONGEST
    assert str(InputError(long)).endswith("; use y")
    assert len(as_text(ValueError(long))) <= LONGEST
