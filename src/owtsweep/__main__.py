"""`owtsweep`, `python -m owtsweep`: run one command, obey signals, and end the process."""

import os
import signal
import sys
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import NoReturn

#: The signals that stop a command: Ctrl-C, `kill`, and the end of the terminal (not on Windows).
STOPS = ("SIGINT", "SIGTERM", "SIGHUP")
#: The variables by which the libraries of linear algebra learn how many threads they may start.
BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
#: A stopped command may take this many seconds to end. Threads that schemes have started may
#: outlive the command by as many seconds.
GRACE = 5

#: Time (s) after which a stop that Python has lost is raised again.
AGAIN = 0.02

_stopped_by = 0
_lost = False


def run() -> NoReturn:
    """Run the command line, then end the process.

    The exit code is that of the command, or 128 plus the number of the signal that stopped it.
    """
    _use_one_blas_thread()
    present = [getattr(signal, name) for name in STOPS if hasattr(signal, name)]
    # A signal that is ignored stays ignored (`nohup`, or a background job of a script).
    numbers = [number for number in present if signal.getsignal(number) is not signal.SIG_IGN]
    for number in numbers:
        signal.signal(number, _stop)
    sys.unraisablehook = _raise_again
    # Silences the process that removes what a pool of processes left behind.
    sys.warnoptions.append("ignore:resource_tracker:UserWarning")
    _open_missing_streams()
    try:
        from owtsweep import compiled
        from owtsweep.cli import main

        compiled.name_command()
        code = main()
    except BaseException:
        if not _stopped_by:
            raise
        _say("interrupted")  # while the command was starting or ending
        code = 128 + _stopped_by
    if _stopped_by and code:
        # A library interrupted while it loads may abort the normal exit of the interpreter.
        _end(128 + _stopped_by)
    _flush()
    _end_workers()
    for number in numbers:  # they would kill the interpreter while it ends
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_late, args=(code,), daemon=True).start()
    sys.exit(code)


def _use_one_blas_thread() -> None:
    """Let linear algebra run on one thread, unless the user has set the number of threads.

    The matrices are small: threads that wait for each other take up to a hundred times longer. The
    libraries read the variables when they are loaded, so this must happen before NumPy is imported.
    """
    for name in BLAS_THREADS:
        os.environ.setdefault(name, "1")


def _open_missing_streams() -> None:
    """Open the null device for each standard stream that is closed, e.g. by `>&-` in a shell.

    Otherwise the next file that is opened would get the stream's number, and all that libraries and
    child processes print.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = open(os.devnull, mode, encoding="utf-8")  # noqa: SIM115
            os.set_inheritable(stream.fileno(), True)
            setattr(sys, name, stream)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, RuntimeError):  # a full disk, no reader, closed, busy
            with suppress(OSError, ValueError):  # the interpreter would try again, and complain
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _stop(number: int, frame: FrameType | None) -> None:
    """Handle a signal: raise `KeyboardInterrupt`, so that the command says what is stored and ends.

    At a second signal, or if the command has not ended after `GRACE` seconds, end the process at
    once.
    """
    global _stopped_by, _lost
    if _lost and number == signal.SIGALRM:
        _lost = False
        signal.alarm(GRACE)
        raise KeyboardInterrupt
    if _stopped_by:
        _say("stopped at once; finished blocks are kept")
        _end(128 + _stopped_by)
    _stopped_by = number
    if hasattr(signal, "alarm"):  # a library may swallow the exception, and go on
        signal.signal(signal.SIGALRM, _stop)
        signal.alarm(GRACE)
    raise KeyboardInterrupt


def _raise_again(lost: "sys.UnraisableHookArgs") -> None:
    """Let a `KeyboardInterrupt` that Python has lost be raised again; report all other exceptions.

    Python drops exceptions that are raised in a callback of the garbage collection: a stop that
    comes just then would be reported as a traceback and have no effect.
    """
    global _lost
    if lost.exc_type is not KeyboardInterrupt or not hasattr(signal, "setitimer"):
        sys.__unraisablehook__(lost)
        return
    _lost = True  # a moment later, because here the exception would be lost once more
    signal.setitimer(signal.ITIMER_REAL, AGAIN)


def _end_late(code: int) -> None:
    """End the process with the exit code `code`, after `GRACE` seconds.

    Python's interpreter alone might wait for ever for a thread that does not end.
    """
    time.sleep(GRACE)
    _say("a thread that was started here does not end, and is ended")
    _end(code)


def _say(text: str) -> None:
    with suppress(OSError):  # not `print`: the signal may have interrupted a `print`
        os.write(2, f"owtsweep: {text}\n".encode())


def _end(code: int) -> NoReturn:
    """End this process at once, after all of its worker processes."""
    _flush()
    _end_workers()
    os._exit(code)


def _end_workers() -> None:
    """End the worker processes of joblib, and all processes that the workers have started.

    Their results are stored. Left to themselves, they would take seconds to unload their libraries,
    and this process would wait for them.
    """
    if "joblib" in sys.modules:
        from multiprocessing import active_children
        from multiprocessing.process import BaseProcess

        try:
            from joblib.externals.loky.backend.utils import kill_process_tree as kill
        except ImportError:  # another joblib; then what the workers have started goes on
            kill = BaseProcess.kill
        for child in active_children():
            kill(child)


if __name__ == "__main__":
    run()
