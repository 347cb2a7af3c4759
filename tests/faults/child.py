"""A sweep of the dummy study in a process of its own: `child.py RESULTS BACKEND SECONDS LEVELS`.

Every block takes SECONDS. Ends as the command line does. FAULTS of the environment are the study's.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from types import SimpleNamespace

from dummy_study import DummyStudy, make_config

from owtsweep import __main__ as process
from owtsweep import studies
from owtsweep.cli import program
from owtsweep.cli import running as command
from owtsweep.config import changed
from owtsweep.sweep import progress

if __name__ == "__main__":
    # Whoever starts the tests in the background leaves Ctrl-C ignored to all that they start.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    results, backend, seconds, levels, *scheduler = sys.argv[1:]
    c = make_config(
        results, backend=backend, workers=2, level=[float(i + 1) for i in range(int(levels))]
    )
    if scheduler:
        c = changed(c, compute=changed(c.compute, scheduler=scheduler[0]))
    study = DummyStudy(json.loads(os.environ.get("FAULTS", "{}")), pause=float(seconds))
    studies.get_study = lambda name: study
    program.import_module = lambda name: SimpleNamespace(
        run=lambda options, argv: command.run_one(c, ["sweep", "grid.note=two words"])
    )
    progress.make_progress = lambda: progress.Progress()
    sys.argv[1:] = ["sweep", "grid.note=two words"]
    process.run()
