"""Runs a command line in this process and holds it to what the program promises."""

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

#: Seconds after which a command hangs.
PATIENCE = 60
#: What no output may hold: control characters but line ends, marks of direction, half characters.
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
#: How lines on stderr begin when a command is refused.
LINES = ("owtsweep: ", "note: ", "  ")


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    code: int
    out: str
    err: str


def judge(main: Callable[[list[str]], int], argv: Sequence[str], folder: Path) -> Ended:
    """Run a command line in a folder and check what every command promises.

    No exception, an exit code of 0, 1 or 2, no control character in the output, and no hang. With
    code 2: the reason is one line on stderr, and nothing in the folder is new or changed, except
    that a damaged shard may be set aside.

    Raises
    ------
    AssertionError
        If a promise is broken; the message holds the command and what it said.
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
    """Run a command line; return its exit code and what it printed.

    Raises
    ------
    AssertionError
        If an exception leaves it, if it takes longer than `PATIENCE`, or if it starts a process
        that a file names.
    """
    logging.getLogger("owtsweep").handlers.clear()  # they hold an earlier test's stderr
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
        except SystemExit as ended:  # of --help and --version
            code = 0 if ended.code in (0, None) else -1
        except Exception as error:
            raise AssertionError(f"owtsweep {' '.join(argv)!r:.300}: {error!r:.500}") from error
    return Ended(code, *(_text(stream) for stream in (out, err)))


def _text(stream: io.TextIOWrapper) -> str:
    stream.flush()
    return stream.buffer.getvalue().decode("utf-8", "surrogateescape")  # type: ignore[attr-defined]


def list_files(folder: Path) -> dict[str, str]:
    """What lies in a folder: name -> kind, size and digest."""
    content = {}
    for path in sorted(folder.rglob("*")):
        mode = path.lstat().st_mode
        digest = hashlib.md5(path.read_bytes()).hexdigest() if stat.S_ISREG(mode) else ""
        content[str(path.relative_to(folder))] = f"{stat.S_IFMT(mode)} {digest}"
    return content


@contextlib.contextmanager
def _limit_time(argv: Sequence[str]) -> Iterator[None]:
    def expire(*_: object) -> None:
        raise TimeoutError(f"{argv} took more than {PATIENCE} s")

    before = signal.signal(signal.SIGALRM, expire)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def _forbid_processes() -> Iterator[None]:
    """Let no process start but git, which the manifest asks for the commit."""
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
