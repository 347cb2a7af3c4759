"""Choose five inclinometers for a structure of your own, before anything is mounted.

    python examples/tower_sensors.py [STRUCTURE] [HEIGHT ...] [KEY=VALUE ...]

STRUCTURE is a name in conf/structure or the path of a YAML file (default: iea15). It is cut at the
ground and at its top; soil and what stands on the top play no part in the estimate. HEIGHTs are
those to choose from, in m above the ground (default: the ends of all elements, none of which is
longer than a thirteenth of the structure). KEY=VALUE sets a key of the tower study, e.g.
wind.thrust.mean=7e5 (its loads are those of a 15 MW turbine).

Five accelerometers are there already, spread over the height. Printed are the chosen heights, the
predicted error of the augmented Kalman filter, and what a sixth inclinometer would buy. Errors are
parts of the signals' standard deviations, which one short simulated record gives; each sensor has
noise of 1 % of its own signal's. Bad input ends the program with one line and exit code 2.
"""

from __future__ import annotations

import sys

import owtsweep
from owtsweep.structures import find_structure
from owtsweep.studies.composing import compose
from owtsweep.studies.tower.placement import Choice, choose_greedily, extend
from owtsweep.studies.tower.placement_case import divide_tubes, make_case

COUNT = 5
#: Elements over the height, at least.
ELEMENTS = 13
SHORT = ["record.duration=200", "record.settling=50"]


def main(arguments: list[str]) -> int:
    try:
        overrides = [word for word in arguments if "=" in word]
        words = [word for word in arguments if "=" not in word]
        heights = [read_height(word) for word in words[1:]] or None
        structure = find_structure(words[0] if words else "iea15")
        height = structure.hub - structure.mudline
        structure = divide_tubes(structure, height / ELEMENTS, heights or ())
        config = compose(["study=tower", *SHORT, *overrides])
        case = make_case(config, structure, inclinometers=heights)
        problem = case.problem
        choices = choose_greedily(problem, COUNT)
    except owtsweep.InputError as error:
        print(f"tower_sensors: {error}", file=sys.stderr)
        return 2
    above = case.setting.cut.heights - case.setting.cut.heights[0]
    given = ", ".join(f"{above[channel.node]:.4g}" for channel in case.setting.channels)
    print(f"{structure.name}: {height:g} m from the ground to the upper cut")
    print(f"accelerometers at {given} m")
    for choice in choices:
        tell(choice, case.welds[choice.weld])
    chosen = choices[-1]
    further = extend(problem, chosen)
    if further:
        sixth = min(further, key=lambda choice: choice.stress)
        added = (set(sixth.heights) - set(chosen.heights)).pop()
        print(
            f"a sixth, best at {added:.4g} m, would lower the stress error by "
            f"{100 * (1 - sixth.stress / chosen.stress):.1f} % and that of M0 by "
            f"{100 * (1 - sixth.moment / chosen.moment):.1f} %"
        )
    return 0


def read_height(word: str) -> float:
    """Read a height in m.

    Raises
    ------
    InputError
        If the word is no number.
    """
    try:
        return float(word)
    except ValueError:
        raise owtsweep.InputError(
            f"{word!r} is no height; give numbers in m above the ground behind the structure"
        ) from None


def tell(choice: Choice, weld: float) -> None:
    """Print the heights and the predicted errors of a choice."""
    heights = ", ".join(f"{height:.4g}" for height in choice.heights)
    print(
        f"{len(choice.heights)} inclinometers at {heights} m: stress {100 * choice.stress:.1f} % "
        f"(worst weld, {weld:.4g} m), M0 {100 * choice.moment:.1f} %"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
