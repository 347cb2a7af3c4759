"""Compiles the kernels of a study before its first block, in several processes side by side.

numba compiles under a lock, so threads would compile one after the other. Processes share what they
compile by the folder of compiled kernels.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import owtsweep
from owtsweep import compiled  # in this form the module counts as no source of kernels
from owtsweep.errors import as_text
from owtsweep.vectors import choose, uses_vectors

logger = logging.getLogger(__name__)

#: What is compiled -> seconds of one core, measured; the order is that in which a process compiles.
#: `whole` calls `prepare`, `span` and `finish`, and is quick once these are in the folder.
PARTS = {
    "prepare": 5.0, "span": 2.2, "finish": 1.3, "recursion": 2.4, "covariances": 1.7,
    "feeding": 0.8, "leaving": 0.7, "whole": 2.5,
}  # fmt: skip

#: Seconds that a process takes to start and to import numba.
START = 1.5

#: Most processes: `prepare` and then `whole` take as long as all other parts in two processes.
MOST = 3


def compile_kernels(evaluation: str, *, vectors: bool, cores: int) -> None:
    """Compile the kernels of the batch engine that are not compiled yet, one share per core.

    Without another core, or if nothing has to be compiled, nothing is done. What a process fails to
    compile, e.g. because it cannot be started, is compiled when it is first called.

    Parameters
    ----------
    evaluation
        "superposed" or "direct": which of the two kernels that run records is used.
    vectors
        Whether kernels are compiled with LLVM vectors (`owtsweep.vectors`).
    cores
        Number of processes that may run side by side.
    """
    choose(vectors)
    folder = compiled.usable_directory()
    if cores < 2 or _is_compiled(evaluation, folder):
        return
    compiled.announce(folder)
    shares = make_shares(min(cores, MOST))
    done: dict[str, float] = {}
    running: list[subprocess.Popen[str]] = []
    began = time.perf_counter()
    try:
        for share in shares:
            running.append(_start(evaluation, share))
            threading.Thread(target=_follow, args=(running[-1], done, began), daemon=True).start()
        while any(process.poll() is None for process in running):
            _show(tell_left(shares, dict(done), time.perf_counter() - began))
            time.sleep(0.2)
    except OSError as error:  # no more processes, say: must not stop the computation
        logger.info("kernels are compiled one after the other: %s", as_text(error))
    finally:
        _show("")
        for process in running:
            process.kill()
            process.wait()


def _is_compiled(evaluation: str, folder: Path) -> bool:
    """Return whether the kernel that calls nearly all others is in the folder."""
    version = f"py{sys.version_info.major}{sys.version_info.minor}"
    return any(folder.rglob(f"runs.{evaluation}-*.{version}.nbi"))


def make_shares(processes: int) -> list[list[str]]:
    """Deal the parts to processes, each part to the process that has the least seconds to do.

    `whole` comes last in the process of `prepare`, the longest of the parts that `whole` calls.
    """
    shares = [["prepare"], *([] for _ in range(processes - 1))]
    seconds = [PARTS["prepare"] + PARTS["whole"], *[0.0] * (processes - 1)]
    for part in list(PARTS)[1:-1]:
        least = seconds.index(min(seconds))
        shares[least].append(part)
        seconds[least] += PARTS[part]
    shares[0].append("whole")
    return shares


def tell_left(shares: Sequence[Sequence[str]], done: Mapping[str, float], seconds: float) -> str:
    """Return a line: how many parts are done, and about how many seconds are left.

    `done` are the finished parts with the time at which each was done, and `seconds` is the present
    time, in s since the processes were started. The estimate rests on the seconds of `PARTS`, times
    how much longer the part that was finished last has taken. If a part is overdue, the estimate
    grows.
    """
    due: dict[str, float] = {}
    overdue = [0.0]
    for share in shares:
        at = START
        for part in share:
            at += PARTS[part]
            due[part] = at
        overdue += [seconds / due[part] for part in share if part not in done][:1]
    newest = max(done, key=lambda part: done[part], default=None)
    pace = 1.0 if newest is None else done[newest] / due[newest]
    left = max(max(pace, *overdue) * max(due.values()) - seconds, 1.0)
    return f"compiling kernels, once: {len(done)} of {len(due)} parts, about {left:.0f} s left"


def _show(line: str) -> None:
    """Write a line over the last one if stderr is a terminal; otherwise do nothing."""
    if sys.stderr.isatty():
        print(f"\r{line}\x1b[K", end="", file=sys.stderr, flush=True)


def _start(evaluation: str, share: Sequence[str]) -> subprocess.Popen[str]:
    """Start a process that compiles a share, and prints the name of each finished part."""
    form = "vectors" if uses_vectors() else "plain"
    # -P and the path: the process imports this owtsweep, and no module of the current folder
    words = [sys.executable, "-P", "-m", f"{__name__}.share", evaluation, form, *share]
    paths = [str(Path(owtsweep.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    return subprocess.Popen(
        words,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )


def _follow(process: subprocess.Popen[str], done: dict[str, float], began: float) -> None:
    """Add each part that a process has finished to `done`, with the seconds since `began`."""
    for line in process.stdout or ():
        done[line.strip()] = time.perf_counter() - began
