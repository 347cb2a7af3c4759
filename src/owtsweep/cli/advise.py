"""The command `advise`: say which estimator to run in one case, and what would change that."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from textwrap import fill

from owtsweep.cli.program import DONE
from owtsweep.cli.running import WIDTH
from owtsweep.process import keep_freed_memory


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Print the answer, then levers and other worlds line by line as computed; return 0.

    With `--json`, print one JSON object at the end instead.

    Raises InputError if the configuration is refused, or has several cells.
    """
    from owtsweep.advice.advising import Advice
    from owtsweep.advice.question import ask
    from owtsweep.sweep.progress import make_progress

    keep_freed_memory()
    question = ask(options.overrides, options.config_dir)
    advice = Advice(question)
    for line in advice.tell(make_progress(), quick=options.quick):
        if not options.json:
            print(fill(line, WIDTH, break_on_hyphens=False), flush=True)
    if options.json:
        print(json.dumps(advice.as_plain(), indent=2))
    return DONE
