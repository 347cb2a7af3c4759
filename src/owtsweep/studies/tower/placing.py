"""Chooses inclinometers for the command `place`."""

from __future__ import annotations

from collections.abc import Collection
from itertools import pairwise

from owtsweep.config import changed
from owtsweep.config.hints import suggest_name
from owtsweep.errors import require
from owtsweep.io.terminal import tell_step
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import describe_errors
from owtsweep.studies.tower.placed import QUANTITIES, PlacedSensors
from owtsweep.studies.tower.placement import choose_greedily, extend, pose, predict
from owtsweep.studies.tower.placement_case import divide_tubes, make_case
from owtsweep.sweep.study import PlaceQuestion

#: Most sensors that are chosen if the user does not say.
COUNT = 8
#: Elements over the height, at least, at whose ends sensors may be.
ELEMENTS = 13
#: Least distance of two heights to choose from, m.
APART = 0.01
#: Key -> its value if the user sets none; with `paper`, loads are declared, not told.
DEFAULTS = {"grid.noise": "[1]", "tuning": "paper", "sensors": "accelerometers"}
#: Keys that have no part in the choice -> why.
NO_PART = dict.fromkeys(
    ("schemes", "criterion", "fatigue", "grid.soil_factor", "grid.replicates"),
    "its answer is the covariance of the AKF, on which this key has no influence",
)
NO_PART["recorded"] = "it simulates the record that gives the size of every signal"


def list_defaults(given: Collection[str]) -> list[str]:
    """Return the overrides that `place` puts before those of the user, who sets the keys `given`.

    They are one noise, the tuning paper and, if the user names no sensor, accelerometers at every
    node, which `place` thins out. Raise `InputError` if a given key has no part in the choice.
    """
    for key in sorted(given):
        parts = key.split(".")
        for end in range(1, len(parts) + 1):
            why = NO_PART.get(".".join(parts[:end]), "")
            require(not why, f"{key}: `place` does not take it, because {why}; leave it out")
    start = [f"{key}={value}" for key, value in DEFAULTS.items() if key not in given]
    if not _name_sensors(given):
        start += ["sensors.accelerometers=[]", "sensors.every_node=[accelerometers]"]
    return start


def place(config: TowerConfig, question: PlaceQuestion) -> PlacedSensors:
    """Choose inclinometers one by one, and predict the AKF's error with each number of them.

    Raise `InputError` if the configuration or the question cannot be answered; the message says
    what could.
    """
    quantity = question.quantity or next(iter(QUANTITIES))
    require(
        quantity in QUANTITIES,
        f"--quantity: there is no {quantity!r}; {suggest_name(quantity, list(QUANTITIES))}",
    )
    _check(config, question)
    heights, (low, high) = question.heights, config.heights
    divided = divide_tubes(config.structure, (high - low) / ELEMENTS, heights or ())
    divided.check()
    spread = not _name_sensors(question.given)
    tell_step(f"a record of {config.record.duration:g} s, for the size of every signal")
    case = make_case(changed(config, structure=divided), inclinometers=heights, spread=spread)
    problem, criterion = pose(case), QUANTITIES[quantity][0]
    candidates = len(problem.heights)
    count = min(COUNT, candidates) if question.count is None else question.count
    tell_step(f"inclinometers one by one, of {candidates} heights")
    choices = choose_greedily(problem, count, criterion)
    further = extend(problem, choices[-1])
    if spread:
        sensors = changed(
            config.sensors, name="spread", every_node=[], accelerometers=case.list_there()["a"]
        )
        config = changed(config, sensors=sensors)
    return PlacedSensors(
        config=config,
        case=case,
        quantity=quantity,
        spread=spread,
        choices=tuple(choices),
        further=min(further, key=lambda choice: choice.error(criterion)) if further else None,
        everywhere=predict(problem, range(candidates)),
    )


def _name_sensors(given: Collection[str]) -> bool:
    return any(key.partition(".")[0] == "sensors" for key in given)


def _check(config: TowerConfig, question: PlaceQuestion) -> None:
    require(
        "" in config.by_tuning(),
        f"tuning: `place` takes one tuning; name one, e.g. tuning={next(iter(config.tunings), '')}",
    )
    noise = config.grid.noise
    require(
        len(noise) == 1,
        f"grid.noise: `place` takes one noise; give one, e.g. grid.noise=[{noise[0]:g}]",
    )
    wrong = describe_errors(config)
    require(
        not wrong,
        f"model and faults: the AKF's covariance does not know what is wrong ({wrong}), so `place` "
        "would not either; leave that out here, and run `sweep` with the sensors chosen",
    )
    count = question.count
    require(count is None or count >= 1, f"--count: {count} sensors are none; give 1 or more")
    if question.heights is None:
        return
    low, high = (height - config.structure.mudline for height in config.heights)
    for height in question.heights:
        require(
            low <= height <= high,
            f"--heights: {height:g} m is outside; give heights above the ground from {low:g} to "
            f"{high:g} m, where the cuts are",
        )
    for below, above in pairwise(question.heights):
        require(
            above - below >= APART,
            f"--heights: {below:.9g} and {above:.9g} m are one place; leave one out",
        )
    require(
        count is None or count <= len(question.heights),
        f"--count: {count} inclinometers, but there are {len(question.heights)} heights; give more "
        "heights or choose fewer",
    )
