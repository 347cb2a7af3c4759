"""Say where the numbers of compared runs come from: what all runs share, and what differs."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.comparing.aspects import Aspects

#: Greatest number of different values of one setting that are listed.
MOST_VALUES = 4


def describe_origins(aspects: Sequence[Aspects]) -> str:
    """Return sentences on the tuning, truth, seed and number of records of compared runs.

    One sentence lists the settings that have one value in all runs, with this value. Another lists
    the settings that differ between the runs, with their values. The text is empty if the study
    does not say where its numbers come from.

    Parameters
    ----------
    aspects
        The study's description of each run, in the order of the runs.
    """
    names = dict.fromkeys(name for told in aspects for name in told.origin)
    common, different = [], []
    for name in names:
        values = list(dict.fromkeys(told.origin.get(name, "none") for told in aspects))
        if len(values) == 1:
            common.append(f"{name} {values[0]}")
            continue
        shown = [*values[:MOST_VALUES], "..."] if len(values) > MOST_VALUES else values
        different.append(f"{name} ({', '.join(shown)})")
    sentences = []
    if common:
        sentences.append(f"In all runs: {', '.join(common)}.")
    if different:
        sentences.append(f"The runs differ in {', '.join(different)}.")
    return " ".join(sentences)
