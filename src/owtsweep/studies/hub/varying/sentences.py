"""Says in a sentence or two per motion what the values of a key change."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import compress

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.expected.answers import RESOLUTION, find_winning
from owtsweep.studies.hub.varying.errors import Errors

#: Errors that differ by less than this fraction are called equal.
LEAST_CHANGE = 0.005


def unit_of_error(errors: Errors) -> str:
    """Return the unit of the root mean square errors, "m" or "m/s"."""
    return "m/s" if errors.criterion == "velocity" else "m"


def describe_error(errors: Errors) -> str:
    """Return in words, with the unit, which error is shown."""
    what = {"position": "position, x + y", "velocity": "velocity, vx + vy"}
    criterion = errors.criterion
    return f"rms error of {what.get(criterion, f'position, {criterion}')} ({unit_of_error(errors)})"


def describe_motion(period: float, amplitude: float) -> str:
    """Return a motion in words, e.g. "natural period 4 s, amplitude 0.5 m"."""
    return f"natural period {period:g} s, amplitude {amplitude:g} m"


def find_best(errors: Errors, names: Sequence[str]) -> list[list[tuple[str, ...]]]:
    """Return which of `names` have the least error at each motion and, in there, each value.

    They are several where the expected errors, accurate to `RESOLUTION`, cannot tell them apart.
    """
    mse = errors.mse[errors.criterion][: len(names)]
    best = mse <= (1.0 + RESOLUTION) * mse.min(axis=0)
    return [
        [tuple(compress(names, at)) for at in at_values.T] for at_values in np.moveaxis(best, 2, 0)
    ]


def list_names(names: Sequence[str]) -> str:
    """Return names as one text, e.g. "EKF, MKF or HME1"."""
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def answer_each(errors: Errors) -> Iterator[str]:
    """Yield for each motion the sentences on the best scheme, the bound and the baselines."""
    least = errors.rms()[: len(errors.schemes)].min(axis=0)
    for number, motion in enumerate(errors.motions):
        best = [list_names(names) for names in find_best(errors, errors.schemes)[number]]
        parts = [_follow_best(errors, best, least[:, number])]
        parts += _name_baselines(errors, number)
        start = f"At {describe_motion(*motion)}: " if len(errors.motions) > 1 else ""
        yield start + " ".join(parts)


def _follow_best(errors: Errors, best: list[str], least: Array) -> str:
    """Return a sentence on the best scheme's rms error, `least`, over the values, and the bound."""
    show, values, unit = errors.along.show, errors.values, unit_of_error(errors)
    bound = errors.rms_of_bound()
    if isinstance(values[0], str):
        low, high = int(np.argmin(least)), int(np.argmax(least))
        text = " and ".join(
            f"{what} with {show(values[n])} ({best[n]}, {least[n]:.3g} {unit}; "
            f"bound {bound[n]:.3g} {unit})"
            for what, n in (("smallest", low), ("largest", high))
        )
        if not _differ(least[low], least[high]):
            return f"The best scheme's error is the same at all values: {least[low]:.3g} {unit}."
        return f"The best scheme's error is {text}."
    ends = f"From {show(values[0])} to {show(values[-1])}"
    verb, verb_of_bound = (_name_change(of[0], of[-1]) for of in (least, bound))
    sentence = (
        f"{ends} the best scheme's error {verb} from {least[0]:.3g} {unit} ({best[0]}) to "
        f"{least[-1]:.3g} {unit} ({best[-1]}), and the Kalman bound {verb_of_bound} from "
        f"{bound[0]:.3g} to {bound[-1]:.3g} {unit}."
    )
    for what, n, end in (
        ("smallest", int(np.argmin(least)), min(least[0], least[-1])),
        ("largest", int(np.argmax(least)), max(least[0], least[-1])),
    ):
        if _differ(least[n], end):
            sentence += (
                f" The error is {what} at {show(values[n])}: {least[n]:.3g} {unit} ({best[n]})."
            )
    return sentence


def _differ(one: float, other: float) -> bool:
    return abs(other - one) > LEAST_CHANGE * max(one, other)


def _name_change(first: float, last: float) -> str:
    if not _differ(first, last):
        return "hardly changes,"
    return "falls" if last < first else "rises"


def _name_baselines(errors: Errors, motion: int) -> list[str]:
    """Return a sentence on each baseline that is best, and beats every scheme, at some values."""
    mse, count = errors.mse[errors.criterion][:, :, [motion]], len(errors.schemes)
    winning, _ = find_winning(mse[count:], mse[:count].min(axis=0))
    sentences = []
    for number, name in enumerate(errors.baselines):
        places = [
            errors.along.show(value)
            for value, winner in zip(errors.values, winning[:, 0], strict=True)
            if winner == number
        ]
        if places:
            sentences.append(f"{name} has less error than every scheme at {', '.join(places)}.")
    return sentences
