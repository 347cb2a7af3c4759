"""`python -m owtsweep`: the process of one command, what stops it, and how it ends."""

import os
import signal
import sys
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import NoReturn

#: What stops a command: Ctrl-C, `kill`, and the end of its terminal (Windows has no SIGHUP).
STOPS = ("SIGINT", "SIGTERM", "SIGHUP")
#: Seconds that a stopped command may take to end, and that threads and processes that schemes have
#: started may outlive the command.
GRACE = 5

_stopped_by = 0


def run() -> NoReturn:
    """Run the command line and end the process with its exit code; 128 + signal if stopped."""
    present = [getattr(signal, name) for name in STOPS if hasattr(signal, name)]
    # What is ignored stays so (`nohup`, a script's background).
    numbers = [number for number in present if signal.getsignal(number) is not signal.SIG_IGN]
    for number in numbers:
        signal.signal(number, _stop)
    # For the process that tidies up after a pool: nobody need know that it had to.
    sys.warnoptions.append("ignore:resource_tracker:UserWarning")
    _open_missing_streams()
    try:
        from owtsweep.cli import main

        code = main()
    except BaseException:
        if not _stopped_by:
            raise
        _say("interrupted")  # as it began, or as it ended
        code = 128 + _stopped_by
    if _stopped_by and code:
        # A library interrupted while it loads may abort the normal exit of the interpreter.
        _end(128 + _stopped_by)
    _flush()
    for number in numbers:  # as the interpreter ends, it would die of them
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_late, args=(code,), daemon=True).start()
    sys.exit(code)


def _open_missing_streams() -> None:
    """Give the null device to streams that were closed (`>&-`): else a file would get their number,
    and all that libraries and other processes print.
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
    """Stop the command so that it says what is stored; the second time, at once."""
    global _stopped_by
    if _stopped_by:
        _say("stopped at once; finished blocks are kept")
        _end(128 + _stopped_by)
    _stopped_by = number
    if hasattr(signal, "alarm"):  # a library may swallow the exception, and go on
        signal.signal(signal.SIGALRM, _stop)
        signal.alarm(GRACE)
    raise KeyboardInterrupt


def _end_late(code: int) -> None:
    """End the process after all: the interpreter would wait for threads for ever."""
    time.sleep(GRACE)
    _say("a thread or process that was started here does not end, and is ended")
    _end(code)


def _say(text: str) -> None:
    with suppress(OSError):  # not `print`: a signal may have come while it was at work
        os.write(2, f"owtsweep: {text}\n".encode())


def _end(code: int) -> NoReturn:
    """End the process now, and the processes of a pool with their children."""
    _flush()
    if "joblib" in sys.modules:
        from multiprocessing import active_children

        from joblib.externals.loky.backend.utils import kill_process_tree

        for child in active_children():
            kill_process_tree(child)
    os._exit(code)


if __name__ == "__main__":
    run()
