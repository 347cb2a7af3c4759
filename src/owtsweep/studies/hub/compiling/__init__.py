"""Compiles the kernels that a command uses before it begins, in several processes side by side.

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
from contextlib import suppress
from pathlib import Path

from owtsweep import compiled  # in this form the module counts as no source of kernels
from owtsweep.errors import as_text
from owtsweep.vectors import choose, uses_vectors

logger = logging.getLogger(__name__)

#: What uses kernels -> the parts that are compiled for it -> seconds of one core, measured.
#: `gains` are the gains of filter and smoother; `superposed` and `direct` run simulated records;
#: `expected` is the engine without records; `recorded` runs given series, as for error spectra.
#: The part `whole` calls the other parts, and is quick once these are in the folder.
PARTS: Mapping[str, Mapping[str, float]] = {
    "gains": {"recursion": 2.0, "covariances": 1.4, "leaving": 0.6},
    "superposed": {"prepare": 4.0, "span": 1.8, "finish": 1.4, "feeding": 0.7, "whole": 2.3},
    "direct": {"prepare": 4.0, "span": 1.8, "finish": 1.4, "feeding": 0.7, "whole": 2.3},
    "expected": {"prepare": 3.8, "finish": 1.4, "squares": 0.6, "whole": 4.0},
    "recorded": {"prepare": 3.8, "finish": 1.4, "whole": 2.2},
    "online": {"horizon": 5.9, "output": 4.5, "filter": 3.2, "whole": 3.4},
}

#: The part that ends a use, in the process that did the use's first part.
LAST = "whole"

#: Seconds that a process takes to start and to import numba.
START = 1.5

#: Most processes: the first part of a use and then `whole` take as long as all its other parts in
#: two processes.
MOST = 3


def compile_kernels(*uses: str, vectors: bool, cores: int | None = None) -> None:
    """Compile the kernels of some uses that are not compiled yet, one share of them per core.

    Without another core, or if nothing has to be compiled, nothing is done. What a process fails to
    compile, e.g. because it cannot be started, is compiled when it is first called.

    Parameters
    ----------
    uses
        What will use kernels, names in `PARTS`.
    vectors
        Whether kernels are compiled with LLVM vectors (`owtsweep.vectors`).
    cores
        Number of processes that may run side by side; None for the number of cores.
    """
    from joblib import cpu_count

    choose(vectors)
    marks = {use: _mark(use) for use in uses}
    missing = [use for use, mark in marks.items() if not mark.exists()]
    processes = min(cores or int(cpu_count()), MOST)
    if processes < 2 or not missing:
        return
    compiled.announce(compiled.usable_directory())
    shares = make_shares(missing, processes)
    done: dict[str, float] = {}
    running: list[subprocess.Popen[str]] = []
    began = time.perf_counter()
    try:
        for share in shares:
            running.append(_start(share))
            threading.Thread(target=_follow, args=(running[-1], done, began), daemon=True).start()
        while any(process.poll() is None for process in running):
            _show(tell_left(shares, dict(done), time.perf_counter() - began))
            time.sleep(0.2)
        for use in missing:
            with suppress(OSError):  # the folder may be full or gone
                marks[use].touch()
    except OSError as error:  # no more processes, say: must not stop the computation
        logger.info("kernels are compiled one after the other: %s", as_text(error))
    finally:
        _show("")
        for process in running:
            process.kill()
            process.wait()


def _mark(use: str) -> Path:
    """Return the path of the empty file that says that the kernels of a use are in the folder."""
    version = f"py{sys.version_info.major}{sys.version_info.minor}"
    return compiled.usable_directory() / f"{use}.{version}.compiled"


def make_shares(uses: Sequence[str], processes: int) -> list[list[str]]:
    """Deal the parts of some uses to processes; a part is written as use.part.

    A use with the part `whole` begins with its longest part, and `whole` comes last in the process
    of that part. Every part goes to the process that has the least seconds to do.
    """
    shares: list[list[str]] = [[] for _ in range(processes)]
    ends: list[list[str]] = [[] for _ in range(processes)]
    seconds = [0.0] * processes
    others: dict[str, float] = {}
    for use in uses:
        (first, *middle), parts = PARTS[use], dict(PARTS[use])
        if LAST in middle:
            least = seconds.index(min(seconds))
            shares[least].append(f"{use}.{first}")
            ends[least].append(f"{use}.{LAST}")
            seconds[least] += parts.pop(first) + parts.pop(LAST)
        others |= {f"{use}.{part}": time for part, time in parts.items()}
    for part, time_of_part in sorted(others.items(), key=lambda item: -item[1]):
        least = seconds.index(min(seconds))
        shares[least].append(part)
        seconds[least] += time_of_part
    return [share + end for share, end in zip(shares, ends, strict=True) if share]


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
        for name in share:
            use, part = name.split(".")
            at += PARTS[use][part]
            due[name] = at
        overdue += [seconds / due[part] for part in share if part not in done][:1]
    newest = max(done, key=lambda part: done[part], default=None)
    pace = 1.0 if newest is None else done[newest] / due[newest]
    left = max(max(pace, *overdue) * max(due.values()) - seconds, 1.0)
    return f"compiling kernels, once: {len(done)} of {len(due)} parts, about {left:.0f} s left"


def _show(line: str) -> None:
    """Write a line over the last one if stderr is a terminal; otherwise do nothing."""
    if sys.stderr.isatty():
        print(f"\r{line}\x1b[K", end="", file=sys.stderr, flush=True)


def _start(share: Sequence[str]) -> subprocess.Popen[str]:
    """Start a process that compiles a share, and prints the name of each finished part."""
    form = "vectors" if uses_vectors() else "plain"
    # -P and the path: the process imports this owtsweep, and no module of the current folder
    words = [sys.executable, "-P", "-m", f"{__name__}.share", form, *share]
    paths = [str(Path(compiled.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
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
