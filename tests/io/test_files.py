"""Atomic writes, and the check that a folder takes files."""

from __future__ import annotations

import os

import pytest

from owtsweep.errors import InputError
from owtsweep.io import files
from owtsweep.io.files import STALE, check_writable, remove_stale, write_all, write_atomically


def test_write_replaces_and_leaves_no_other_file(tmp_path):
    path = tmp_path / "file"
    write_atomically(path, "old")
    write_atomically(path, "née")
    assert path.read_bytes() == "née".encode()
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize("error", [OSError("disk full"), KeyboardInterrupt()])
def test_error_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, step, error):
    path = tmp_path / "file"
    write_atomically(path, b"old")

    def broken(*arguments):
        raise error

    monkeypatch.setattr(files.os, step, broken)
    with pytest.raises(type(error)):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_content_is_on_the_disk_before_the_name_is(tmp_path, monkeypatch):
    steps = []
    fsync, replace = os.fsync, os.replace

    def logged_fsync(descriptor):
        steps.append("fsync")
        fsync(descriptor)

    def logged_replace(source, target):
        assert os.stat(source).st_size == 3
        steps.append("replace")
        replace(source, target)

    monkeypatch.setattr(files.os, "fsync", logged_fsync)
    monkeypatch.setattr(files.os, "replace", logged_replace)
    write_atomically(tmp_path / "file", b"new")
    assert steps == ["fsync", "replace", "fsync"]


@pytest.mark.parametrize("depth", ["", "a", "a/b/c"])
def test_check_leaves_no_trace(tmp_path, depth):
    check_writable(tmp_path / depth)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("below", ["file", "file/a/b", "link/a"])
def test_check_refuses_files_and_dangling_links_in_the_way(tmp_path, below):
    (tmp_path / "file").write_text("")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match=r"^results: .* cannot be written \(.*is no folder\); "):
        check_writable(tmp_path / below)


@pytest.mark.parametrize(
    ("below", "says"),
    [
        ("a" * 300, "File name too long"),
        ("a" * 150 + "/b" * 1900, "folders, one in the other"),
        ("/".join(["a" * 200] * 21), "File name too long"),
    ],
)
def test_check_refuses_what_is_too_long(tmp_path, below, says):
    with pytest.raises(InputError, match=rf"^results: .* cannot be written \(.*{says}") as caught:
        check_writable(tmp_path / below)
    assert len(str(caught.value)) < 500


def test_check_tells_the_reason_of_the_file_system(tmp_path, monkeypatch):
    def refuse(**options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(files.tempfile, "TemporaryFile", refuse)
    with pytest.raises(InputError, match=r"cannot be written \(Permission denied\); name another"):
        check_writable(tmp_path / "a")


def test_all_files_or_none(tmp_path, monkeypatch):
    paths = [tmp_path / name for name in "abc"]
    write_all(dict.fromkeys(paths, "old"))
    through = files._write_through

    def refuse_c(path, data):
        if path.name.startswith(".c."):
            raise OSError(28, "No space left on device")
        through(path, data)

    monkeypatch.setattr(files, "_write_through", refuse_c)
    with pytest.raises(OSError, match="No space"):
        write_all(dict.fromkeys(paths, "new"))
    assert sorted(tmp_path.iterdir()) == paths
    assert [path.read_text() for path in paths] == ["old"] * 3


def test_stale_temporary_files_go_and_nothing_else(tmp_path):
    digits = "0123456789abcdef"
    stale = [tmp_path / f".part-0a.parquet.{digits}.tmp", tmp_path / f".manifest.json.{digits}.tmp"]
    kept = [
        tmp_path / f".part-0b.parquet.{digits}.tmp",  # young: somebody may be writing it
        tmp_path / ".mine.tmp",
        tmp_path / "part-0a.parquet",
        tmp_path / f"notes.{digits}.tmp",
    ]
    for path in [*stale, *kept]:
        path.write_text("")
        if path != kept[0]:
            os.utime(path, (1.0, path.stat().st_mtime - STALE - 1.0))
    remove_stale(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(kept)
