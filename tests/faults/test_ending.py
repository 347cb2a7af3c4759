"""How a command is stopped and ends: signals at any moment, threads left behind, closed streams."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest
from fault_tools import child, content, environment, only_run, undisturbed

from owtsweep.errors import InputError
from owtsweep.sweep.run import sweep

TINY = (
    "experiment=study", "tuning=paper",
    "grid.natural_period=[4.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=2",
    "record.duration=30", "measures.settling_time=5", "schemes=[MKF]",
)  # fmt: skip

#: A command with a worker at work, which goes on after Ctrl-C.
SWALLOWS = """
import signal, subprocess, time
from joblib.externals.loky import get_reusable_executor
import owtsweep.__main__ as process
import owtsweep.cli as cli

def main():
    get_reusable_executor(1).submit(subprocess.run, ["sleep", "60"])
    while True:
        try:
            print("waits", flush=True)
            time.sleep(60)
        except KeyboardInterrupt:
            print("swallowed", flush=True)

signal.signal(signal.SIGINT, signal.default_int_handler)
cli.main = main
process.run()
"""


def command(*words, folder, **options):
    """The command line in a session of its own, where Ctrl-C is not ignored."""
    return subprocess.Popen(
        [sys.executable, "-m", "owtsweep", *words],
        cwd=folder,
        env=environment(),
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        text=True,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
    )


def members(session):
    """The processes of a session."""
    listed = subprocess.run(["ps", "-o", "pid=", "-s", str(session)], capture_output=True)
    return listed.stdout.split()


def wait_until_all_are_gone(session):
    for _ in range(100):
        if not members(session):
            return
        time.sleep(0.05)
    raise TimeoutError(members(session))


@pytest.mark.faults
@pytest.mark.parametrize("backend", ["threading", "loky"])
def test_a_thread_that_never_ends_is_ended(tmp_path, backend):
    process = child(tmp_path / "results", backend, 0, 2, faults={"A1.0": "thread"})
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0
    told = "owtsweep: a thread that was started here does not end, and is ended\n"
    # The thread of a worker process ends with this process, as soon as all is stored.
    assert err == (told if backend == "threading" else "")
    wait_until_all_are_gone(process.pid)
    assert content(only_run(tmp_path / "results")) == undisturbed(tmp_path / "undisturbed", 2)


@pytest.mark.faults
@pytest.mark.parametrize("group", [False, True], ids=["process", "group"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_every_way_to_stop_is_told_and_leaves_no_process(tmp_path, number, group):
    process = child(tmp_path / "results", "loky", 0.2, 20)
    while len(list(tmp_path.glob("results/*/cases/part-*"))) < 3:
        time.sleep(0.02)
    (os.killpg if group else os.kill)(process.pid, number)
    _, err = process.communicate(timeout=10)
    assert process.returncode == 128 + number
    first, second = err.splitlines()
    assert " of 80 cases are stored in " in first
    assert "owtsweep sweep" in second
    wait_until_all_are_gone(process.pid)


@pytest.mark.faults
def test_a_second_ctrl_c_ends_at_once_with_all_workers(tmp_path):
    """And with what workers have started, also where a library swallows each Ctrl-C."""
    with subprocess.Popen(
        [sys.executable, "-c", SWALLOWS], env=environment(), start_new_session=True, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as process:  # fmt: skip
        assert process.stdout.readline() == "waits\n"  # its worker may start later
        while len(members(process.pid)) < 4:  # the last of them sleeps
            time.sleep(0.02)
        os.kill(process.pid, signal.SIGINT)
        assert process.stdout.readline() == "swallowed\n"
        os.kill(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=4)  # before it would be stopped again by itself
    assert process.returncode == 130
    assert err == "owtsweep: stopped at once; finished blocks are kept\n"
    wait_until_all_are_gone(process.pid)


@pytest.mark.faults
def test_two_ctrl_c_together_end_a_sweep(tmp_path):
    process = child(tmp_path / "results", "loky", 60, 2)
    while len(members(process.pid)) < 4:
        time.sleep(0.02)
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGINT)
    os.kill(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=3)
    assert process.returncode == 130
    assert "Traceback" not in err
    wait_until_all_are_gone(process.pid)


@pytest.mark.faults
def test_workers_end_soon_after_the_sweep_is_killed(tmp_path):
    process = child(tmp_path / "results", "loky", 0, 2, faults={"B1.0": "long", "B2.0": "long"})
    while len(list(tmp_path.glob("results/*/cases/part-*"))) < 2:  # then both workers are at B
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)  # the process alone, not its workers
    process.communicate(timeout=10)
    wait_until_all_are_gone(process.pid)


@pytest.mark.faults
def test_workers_that_take_long_to_unload_do_not_hold_a_sweep_up(tmp_path):
    """An idle worker ends its interpreter; a scheme's libraries may need seconds for that."""
    process = child(tmp_path / "results", "loky", 0, 2, faults={"A1.0": "slow end"})
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
    wait_until_all_are_gone(process.pid)


@pytest.mark.faults
def test_ctrl_c_at_any_moment_of_a_multirun(tmp_path):
    words = ["sweep", "--multirun", *TINY, "sensors.gnss.delay=0.1,0.2,0.4"]
    whole = time.monotonic()
    command(*words, folder=tmp_path).communicate()
    whole = time.monotonic() - whole
    for moment in range(1, 16):
        process = command(*words, f"seed={moment}", folder=tmp_path)
        time.sleep(whole * (moment + 1) / 16)  # before, Python itself begins
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=10)
        assert process.returncode in (0, 130)
        assert not [word for word in ("Traceback", "Exception", "Error") if word in err]
        assert process.returncode == 0 or "owtsweep: interrupted" in err
    assert not list(tmp_path.rglob("*.tmp"))


@pytest.mark.faults
@pytest.mark.parametrize("backend", ["threading", "loky"])
def test_closed_streams_do_not_matter(tmp_path, backend, kernels):
    words = ["sweep", *TINY, f"compute.backend={backend}"]
    closing = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", sys.executable, "-m", "owtsweep"]
    done = subprocess.run([*closing, *words], cwd=tmp_path, env=environment())
    assert done.returncode == 0
    assert (only_run(tmp_path / "results") / "summary.csv").exists()


@pytest.mark.parametrize("answer", [b"HTTP/1.1 400 Bad Request\r\n\r\n", b""])
def test_whatever_listens_in_place_of_a_scheduler_is_told(study, config, answer, monkeypatch):
    pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    monkeypatch.setattr("owtsweep.sweep.cluster.PATIENCE_AT_START", 0.4)

    def serve():
        connection, _ = server.accept()
        connection.sendall(answer)
        connection.close()

    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=serve, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(InputError, match=r"^compute.scheduler: no scheduler answers at"):
            sweep(study, config(backend="dask", scheduler=address))


def test_tls_without_certificates_is_told(study, config):
    pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    with pytest.raises(InputError, match=r"^compute.scheduler: tls:// needs certificates"):
        sweep(study, config(backend="dask", scheduler="tls://127.0.0.1:8786"))
