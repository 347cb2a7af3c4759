"""Run a command line in this process, and check that the command keeps the program's promises."""

from __future__ import annotations

import contextlib
import hashlib
import io
import logging
import os
import re
import signal
import stat
import subprocess
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

#: A command that takes more than this many seconds counts as hanging.
PATIENCE = 60
#: What no output may hold: control characters (but tabs and newlines are allowed), marks of the
#: direction of writing, and halves of surrogate pairs.
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
#: How lines on stderr begin when a command is refused.
LINES = ("owtsweep: ", "note: ", "  ")


@dataclass(frozen=True)
class Ended:
    """The exit code of an ended command, and what the command wrote to stdout and stderr."""

    code: int
    out: str
    err: str


def judge(main: Callable[[list[str]], int], argv: Sequence[str], folder: Path) -> Ended:
    """Run a command line and check what every command promises.

    Every command ends in time, without an exception, with the exit code 0, 1 or 2, and prints no
    control character. With code 1, stderr says what failed. With code 2, stderr holds the reason,
    each line begins with one of `LINES`, and nothing in `folder` is new or changed, except shards:
    a damaged shard may be set aside.

    Raises
    ------
    AssertionError
        If a promise is broken; the message holds the command line and the output.
    """
    before = list_files(folder)
    ended = run(main, argv)
    told = f"owtsweep {' '.join(argv)!r:.300}\ncode {ended.code}\n{ended.err[:2000]!r}"
    assert ended.code in (0, 1, 2), told
    assert "Traceback" not in ended.err + ended.out, told
    spoilt = FORBIDDEN.search(ended.out + ended.err)
    assert spoilt is None, f"{spoilt} in {ended.out[:500]!r}\n{told}"
    if ended.code == 2:
        lines = ended.err.splitlines()
        assert lines, told
        assert all(line.startswith(LINES) for line in lines), told
        changed = set(before.items()) ^ set(list_files(folder).items())
        assert not {name for name, _ in changed if "part-" not in name}, f"{changed}\n{told}"
    if ended.code == 1:
        assert "failed" in ended.err, told
    return ended


def run(main: Callable[[list[str]], int], argv: Sequence[str]) -> Ended:
    """Run a command line; return the exit code and the output.

    Raises
    ------
    AssertionError
        If the command raises an exception, or starts a process other than git and uname.
    pytest.fail.Exception
        If the command takes more than `PATIENCE` seconds.
    """
    logging.getLogger("owtsweep").handlers.clear()  # a handler holds an earlier test's stderr
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", "surrogateescape") for _ in range(2))
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        warnings.catch_warnings(),
        _forbid_processes(),
        _limit_time(argv),
    ):
        warnings.simplefilter("ignore", ResourceWarning)
        try:
            code = main(list(argv))
        except SystemExit as ended:  # raised by --help and --version
            code = 0 if ended.code in (0, None) else -1
        except Exception as error:
            raise AssertionError(f"owtsweep {' '.join(argv)!r:.300}: {error!r:.500}") from error
    return Ended(code, *(_text(stream) for stream in (out, err)))


def _text(stream: io.TextIOWrapper) -> str:
    stream.flush()
    return stream.buffer.getvalue().decode("utf-8", "surrogateescape")  # type: ignore[attr-defined]


def list_files(folder: Path) -> dict[str, str]:
    """Return all that lies in a folder: relative path -> kind, and digest if it is a file."""
    content = {}
    for path in sorted(folder.rglob("*")):
        mode = path.lstat().st_mode
        digest = hashlib.md5(path.read_bytes()).hexdigest() if stat.S_ISREG(mode) else ""
        content[str(path.relative_to(folder))] = f"{stat.S_IFMT(mode)} {digest}"
    return content


@contextlib.contextmanager
def _limit_time(argv: Sequence[str]) -> Iterator[None]:
    def expire(*_: object) -> None:
        # no `TimeoutError`: a command would take it for an error of the file that it reads
        pytest.fail(f"{argv} took more than {PATIENCE} s")

    before = signal.signal(signal.SIGALRM, expire)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def _forbid_processes() -> Iterator[None]:
    """Raise `AssertionError` at the context's end if any process but git or uname was started.

    git is allowed because the manifest of a run holds the commit. Inside the context, `os.system`
    starts nothing.
    """
    system, start = os.system, subprocess.Popen.__init__
    harm: list[object] = []

    def refuse(self: object, arguments: Sequence[str], *rest: object, **options: object) -> None:
        if arguments[0] not in ("git", "uname"):
            harm.append(arguments)
        start(self, arguments, *rest, **options)  # type: ignore[arg-type]

    os.system, subprocess.Popen.__init__ = harm.append, refuse  # type: ignore
    try:
        yield
    finally:
        os.system, subprocess.Popen.__init__ = system, start  # type: ignore
    assert not harm, f"processes were started: {harm}"
