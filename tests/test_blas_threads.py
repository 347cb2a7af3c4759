"""The command line lets linear algebra run on one thread, unless the user says otherwise."""

from __future__ import annotations

import os
import subprocess
import sys


def threads_of_a_command(given: dict[str, str]) -> str:
    """The number of BLAS threads that a command of this environment sets, as text."""
    others = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    code = (
        "import atexit, os, sys\n"
        "sys.argv = ['owtsweep', '--help']\n"
        "atexit.register(lambda: print('told:', os.environ['OPENBLAS_NUM_THREADS']))\n"
        "from owtsweep import __main__\n"
        "assert 'numpy' not in sys.modules\n"
        "__main__.run()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env={**others, **given}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split("told:")[1].strip()


def test_a_command_uses_one_thread_unless_told_otherwise():
    assert threads_of_a_command({}) == "1"
    assert threads_of_a_command({"OPENBLAS_NUM_THREADS": "3"}) == "3"
