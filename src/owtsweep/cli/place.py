"""The command `place`: say how many sensors are enough, and where, before any is mounted."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from itertools import pairwise

from owtsweep.cli.program import DONE, INTERRUPTED
from owtsweep.cli.running import name_folder, require_serving, show_answer
from owtsweep.config import dump, get_key
from owtsweep.errors import require
from owtsweep.io.files import refuse_in_one_line, write_all
from owtsweep.sweep.keys import question_hash
from owtsweep.sweep.study import PlaceQuestion, blame

#: Most heights to choose from that are read.
MOST_HEIGHTS = 300


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Choose sensors, write the table and the configuration, print the answer, and return 0.

    Raises InputError if the study has no sensors to place, or the configuration or the question is
        refused.
    """
    from owtsweep.io.tables import dump_tables
    from owtsweep.io.terminal import show_steps
    from owtsweep.studies import compose, locate
    from owtsweep.studies.registry import DEFAULT

    study = require_serving("place", locate(options.overrides).study or DEFAULT)
    given = frozenset(map(get_key, options.overrides))
    question = PlaceQuestion(options.quantity, options.count, _read_heights(options.heights), given)
    with blame(study):
        defaults = study.list_place_defaults(given)
    config = compose([*defaults, *options.overrides], options.config_dir)
    query = f"{question_hash(config)} {question.quantity} {question.count} {question.heights}"
    folder = name_folder("place", config, query)
    with blame(study):
        try:
            with show_steps():
                placed = study.place(config, question)
        except KeyboardInterrupt:
            print("owtsweep: interrupted; nothing is written", file=sys.stderr)
            return INTERRUPTED
        answer, texts = placed.answer(), dump_tables({"place": placed.table()})
    with refuse_in_one_line(folder):
        folder.mkdir(parents=True, exist_ok=True)
        texts["configuration.yaml"] = dump(placed.config)
        write_all({folder / name: text for name, text in texts.items()})
    show_answer(answer)
    print(f"{len(texts)} files: {folder}/")
    return DONE


def _read_heights(text: str | None) -> tuple[float, ...] | None:
    """Return heights in m, upwards, from a text such as "10,25,40"; None if there is none.

    Raises InputError if the text is no list of different numbers.
    """
    if text is None:
        return None
    words = text.strip("[]").split(",")
    require(
        len(words) <= MOST_HEIGHTS,
        f"--heights: {len(words)} are too many; give at most {MOST_HEIGHTS}",
    )
    try:
        heights = sorted(float(word) for word in words)
    except ValueError:
        heights = [math.nan]
    require(
        all(math.isfinite(height) for height in heights),
        f"--heights: {text!r} is no list of heights; give numbers in m above the ground, e.g. "
        "--heights 10,25,40",
    )
    for low, high in pairwise(heights):
        require(low < high, f"--heights: {low:g} m stands there twice; give each height once")
    return tuple(heights)
