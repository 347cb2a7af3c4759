"""The searcher: it finds a minimum, repeats itself, keeps failures, yields until interrupted."""

from __future__ import annotations

import math
from itertools import islice

import pytest

from owtsweep.config import Plain
from owtsweep.errors import InputError
from owtsweep.studies.base.searching import attempt, search

SPACE = {"gain": [1e-3, 1e3, "log"], "window": [0, 40, "int"], "offset": [-1.0, 1.0, "linear"]}
MIXED = {**SPACE, "kind": {"options": ["good", "bad"]}}
START = {"gain": 3.0, "window": 9, "offset": 0.2}


def bowl(values: Plain) -> float:
    """Return a score whose minimum, 1, lies at gain 5, window 12, offset 0 and kind "good"."""
    far = math.log(values["gain"] / 5.0) ** 2 + (values["window"] / 12.0 - 1.0) ** 2
    return 1.0 + far + values["offset"] ** 2 + (values.get("kind") == "bad")


def test_a_minimum_is_found_and_found_again() -> None:
    def make() -> list[tuple[float, Plain]]:
        made = search(MIXED, bowl, trials=80, seed=3, starts=[START])
        return [(trial.score, trial.values) for trial in made]

    trials = make()
    assert len(trials) == 80
    assert min(score for score, _ in trials) < 1.3
    assert make() == trials


def test_values_stay_within_their_bounds() -> None:
    for trial in search(MIXED, bowl, trials=30, seed=1):
        assert 1e-3 <= trial.values["gain"] <= 1e3
        assert trial.values["window"] in range(41)
        assert -1.0 <= trial.values["offset"] <= 1.0
        assert trial.values["kind"] in ("good", "bad")


def test_starts_come_first_and_once_without_values_out_of_bounds() -> None:
    starts = [START, START, {"gain": 2.0, "window": 99, "offset": None, "kind": "worst"}]
    first, second, third = search(MIXED, bowl, trials=3, seed=1, starts=starts)
    assert START.items() <= first.values.items()
    assert second.values["gain"] == 2.0
    assert second.values["window"] != 99
    assert third.values["gain"] != 3.0


def test_a_trial_without_a_score_is_kept_and_the_search_goes_on() -> None:
    def fragile(values: Plain) -> float:
        if values["window"] > 20:
            raise InputError("window: too long")
        return math.nan if values["offset"] > 0.5 else bowl(values)

    trials = list(search(SPACE, fragile, trials=60, seed=2, starts=[START]))
    assert len(trials) == 60
    for trial in trials:
        failed = trial.values["window"] > 20
        assert ("too long" in trial.reason) == failed
        assert math.isinf(trial.score) == (failed or trial.values["offset"] > 0.5)
    assert min(trial.score for trial in trials) < bowl(START)


def test_a_bug_is_no_bad_score() -> None:
    with pytest.raises(KeyError):
        attempt(bowl, {})


def test_an_interrupt_leaves_the_trials_that_were_made() -> None:
    judged: list[Plain] = []

    def interrupted(values: Plain) -> float:
        if len(judged) == 2:
            raise KeyboardInterrupt
        judged.append(values)
        return 1.0

    trials = search(SPACE, interrupted, trials=9, seed=1)
    assert [trial.values for trial in islice(trials, 2)] == judged
    with pytest.raises(KeyboardInterrupt):
        next(trials)
