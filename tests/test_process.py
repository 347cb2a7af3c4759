"""What the process does with memory that it has freed."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

from owtsweep import process

AGAIN_AND_AGAIN = """
import resource
import numpy as np
from owtsweep.process import keep_freed_memory

{call}
for _ in range(3):
    np.ones(6_000_000)
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(10):
    np.ones(6_000_000)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def page_faults(call: str) -> int:
    program = AGAIN_AND_AGAIN.format(call=call)
    # numpy asks for large pages where it can, which would leave little to count.
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": ":".join(sys.path), "NUMPY_MADVISE_HUGEPAGE": "0"},
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return int(done.stdout)


@pytest.mark.skipif(
    sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "mallopt"), reason="not glibc"
)
def test_the_system_does_not_clear_the_same_pages_again():
    assert page_faults("") > 1000
    assert page_faults("keep_freed_memory()") < 100


def test_other_systems_are_left_alone(monkeypatch):
    monkeypatch.setattr(process.sys, "platform", "darwin")
    monkeypatch.setattr(process.ctypes, "CDLL", lambda name: pytest.fail("not glibc"))
    process.keep_freed_memory()
    process.give_back_freed_memory()


def test_another_allocator_is_left_alone(monkeypatch):
    monkeypatch.setattr(process.sys, "platform", "linux")
    monkeypatch.setattr(process.ctypes, "CDLL", lambda name: object())
    process.keep_freed_memory()
    process.give_back_freed_memory()
